"""Faces between the particle cells of a body that may tear (mpm.integrate.fracture_surface).

The face of two neighbours along k is what their material fills of the lattice's: the larger of their volumes over the edge, at most the whole face:
exact in a box along the lattice; where a curved surface cuts both cells, to first order in the cell.
"""

from dataclasses import replace

import numpy as np

from mpm.integrate.fracture_surface import Seams
from mpm.scene.exchange import exchanging_surface
from mpm.scene.refusal import SceneError


def surface_and_seams(experiment, name: str, cut, edges, zero: float, sides, thermal, meets: bool = False):
    """(Surface, Surroundings, Seams) of a body, as mpm.scene.exchange gives them; no seams unless `method.fracture: surface` asks for them."""
    if experiment.method.fracture != "surface":
        return *exchanging_surface(experiment, name, cut, zero, sides, thermal, meets)[:2], None
    more, piece, area = with_seams(cut, edges, experiment.grid.dimension == "axisymmetric")
    surface, surroundings, kept = exchanging_surface(experiment, name, more, zero, sides, thermal, meets)
    return surface, surroundings, None if surroundings is None else seams_of(kept, piece, area)


def refuse_idle(experiment, seams) -> None:
    """SceneError where surfaces are to open and none exchanges heat."""
    if experiment.method.fracture == "surface" and not any(seams):
        raise SceneError(("method", "fracture"), "surface opens faces that exchange heat, and nothing acts on the surface of a body: name it in `surfaces`")


def with_seams(cut, edges, radial: bool):
    """(cut cells with a piece of area zero on either side of every inner face, numbers of those pieces (M, 2), reference areas (M, 2, D))."""
    shape, D = [len(e) - 1 for e in edges], cut.centroid.shape[1]
    index, edge = np.unravel_index(cut.cell, shape), edges[0][1] - edges[0][0]
    number = np.full(int(np.prod(shape)), -1)
    number[cut.cell] = np.arange(len(cut.cell))
    owner, point, area = [], [], []
    for k in range(D):
        inner = np.flatnonzero(index[k] < shape[k] - 1)
        step = int(np.prod(shape[k + 1 :]))
        left, right = inner, number[cut.cell[inner] + step]
        left, right = left[right >= 0], right[right >= 0]
        plane = edges[k][index[k][left] + 1]
        place = 0.5 * (cut.centroid[left] + cut.centroid[right])
        place[:, k] = plane
        filled = [cut.volume[p] / (cut.centroid[p, 0] if radial else 1.0) for p in (left, right)]
        size = np.minimum(np.maximum(*filled) / edge, edge ** (D - 1)) * (place[:, 0] if radial else 1.0)
        normal = np.zeros((len(left), 2, D))
        normal[:, 0, k], normal[:, 1, k] = size, -size
        owner.append(np.stack([left, right], axis=1))
        point.append(np.repeat(place[:, None], 2, axis=1))
        area.append(normal)
    owner, point, area = (np.concatenate(a) for a in (owner, point, area))
    some = area.any(axis=2).all(axis=1)  # on the axis a face has no area
    owner, point, area = owner[some], point[some], area[some]
    flat = area.reshape(-1, D)
    piece = len(cut.owner) + np.arange(2 * len(owner)).reshape(-1, 2)
    more = replace(
        cut, owner=np.concatenate([cut.owner, owner.ravel()]), area=np.concatenate([cut.area, np.zeros(len(flat))]),
        point=np.concatenate([cut.point, point.reshape(-1, D)]), normal=np.concatenate([cut.normal, flat / np.linalg.norm(flat, axis=1, keepdims=True)]),
        side=np.concatenate([cut.side, np.full(len(flat), cut.side.max(initial=0) + 1)]),
    )  # fmt: skip
    return more, piece, area


def seams_of(kept: np.ndarray, piece: np.ndarray, area: np.ndarray) -> Seams:
    """Seams by the numbers of the pieces that a body keeps."""
    found = np.isin(piece, kept).all(axis=1)
    return Seams(np.searchsorted(kept, piece[found]), area[found])
