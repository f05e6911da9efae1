"""What a rigid body's shape and grid fix where temperatures must stay between their data: hat functions, every matrix an M-matrix.

    m_i = int N_i (lumped)     k_e = int_(e's interval) T_e / h^2 on every grid line e between two nodes, T_e the hats across it     b_i = int_side N_i (lumped)
No conductance is negative however the surface cuts a cell, so a backward Euler step of any length ends between the lowest and the highest of its data.
For a linear field k_e is the Galerkin integral: second order inside. A node exchanges over its own depth below the surface,
    beta_i = beta/(1 + beta d_i/kappa),   d_i = int_side N_i (x - x_i) . n / b_i   (negative outside),
which is exact for a linear profile. Bounds and a node outside leave no room below 1 + beta d_i/kappa = LEAST: there the order falls to one.
"""

import functools

import numpy as np

from mpm.rigid.geometry import ORDER, Geometry, evaluated, middles, on_axis
from mpm.rigid.nodes import SNAP, Nodes
from mpm.rigid.touching import covered, surface_beside

LEAST = 0.5


def hat_nodes(lower, upper, h: float, origin) -> tuple[Nodes, list[np.ndarray]]:
    """Nodes of the grid cells that reach the box from `lower` to `upper`, and the grid lines of each direction. Stencil: the node and its next in each."""
    d = len(lower)
    start = np.floor((np.asarray(lower) - origin) / h + SNAP).astype(np.int64)
    end = np.ceil((np.asarray(upper) - origin) / h - SNAP).astype(np.int64)
    count, first, place0 = np.ones(3, dtype=np.int64), np.zeros(3, dtype=np.int64), np.zeros(3)
    count[:d], first[:d], place0[:d] = end - start + 1, start, origin
    stride, step = np.zeros(3, dtype=np.int64), 1
    for k in np.argsort(count[:d], kind="stable"):
        stride[k] = step
        step *= count[k]
    local = np.zeros((2**d, 3), dtype=np.int64)
    local[:, :d] = np.stack(np.meshgrid(*[np.arange(2)] * d, indexing="ij"), axis=-1).reshape(-1, d)
    diff = np.concatenate([[0], np.sort(stride[:d])])
    edges = [origin[k] + h * np.arange(start[k], end[k] + 1) for k in range(d)]
    return Nodes(h, place0, first, count, stride, local, diff, np.zeros((0, 0), dtype=np.int64)), edges


def conductances(nodes: Nodes, d: int, index: np.ndarray, x: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Stencil (d + 1, N) of sum_e k_e (u_i - u_j)^2/2 from quadrature points x (Q, d), w (Q,) whose cells have the nodes `index` (Q, 2^d)."""
    stencil = np.zeros((d + 1, nodes.size))
    base = index[:, 0]
    f = np.empty((len(x), d))
    for k in range(d):
        at = (base // nodes.stride[k]) % nodes.count[k]
        f[:, k] = (x[:, k] - nodes.origin[k]) / nodes.h - nodes.first[k] - at
    for a in range(d):
        row = int(np.searchsorted(nodes.diff, nodes.stride[a]))
        for corner in nodes.local[nodes.local[:, a] == 0]:
            across = np.prod([f[:, k] if corner[k] else 1 - f[:, k] for k in range(d) if k != a], axis=0) * np.ones(len(x))
            near = base + corner @ nodes.stride
            k_e = np.bincount(near, weights=w * np.maximum(across, 0.0), minlength=nodes.size) / nodes.h**2
            stencil[row] -= k_e
            stencil[0] += k_e
            stencil[0, nodes.stride[a] :] += k_e[: -nodes.stride[a]]
    return stencil


def places(nodes: Nodes, d: int) -> np.ndarray:
    """(N, d) places of the nodes."""
    flat = np.arange(nodes.size)
    return np.stack([nodes.origin[k] + nodes.h * (nodes.first[k] + (flat // nodes.stride[k]) % nodes.count[k]) for k in range(d)], axis=-1)


@functools.lru_cache(maxsize=8)
def hat_geometry(shape, axisymmetric: bool, h: float, origin: tuple[float, ...], sides: tuple[str, ...], others: tuple = ()) -> Geometry:
    """As mpm.rigid.geometry.geometry."""
    lower, upper = (np.array(b, dtype=float) for b in shape.bounds())
    d = len(lower)
    if axisymmetric:
        lower[0] = max(lower[0], 0.0)
    nodes, edges = hat_nodes(lower, upper, h, np.asarray(origin, dtype=float))
    edges = on_axis(edges, axisymmetric)
    volume, surface = shape.cut(edges, ORDER)
    beside = surface
    if others:
        beside = surface_beside(shape, others, edges, ORDER, h)
        beside = beside.at(~covered(beside.x, beside.normal, others, h))
    sx, normal = beside.x, beside.normal
    w = volume.w * volume.x[:, 0] if axisymmetric else volume.w
    sw = beside.w * sx[:, 0] if axisymmetric else beside.w
    index, value = evaluated(nodes, volume.x)
    lumped = np.bincount(index.ravel(), weights=(w[:, None] * value).ravel(), minlength=nodes.size)
    stiffness = conductances(nodes, d, index, volume.x, w)
    place, exchange, areas, faces, depths = places(nodes, d), [], [], [], []
    for side in sides:
        part = shape.faces(beside, side, not axisymmetric)
        index, value = evaluated(nodes, sx[part])
        share = (sw[part][:, None] * value).ravel()
        far = np.einsum("sad,sd->sa", sx[part][:, None] - place[index], normal[part]).ravel()
        area = np.bincount(index.ravel(), weights=share, minlength=nodes.size)
        deep = np.bincount(index.ravel(), weights=share * far, minlength=nodes.size)
        stencil = np.zeros_like(stiffness)
        stencil[0] = area
        exchange.append(stencil)
        areas.append(area)
        some = area > 0
        depths.append(np.where(some, deep / np.where(some, area, 1.0), 0.0))
        faces.append((place[some], area[some]))  # lumped too: a node radiates at its own temperature
    sight = evaluated(nodes, np.concatenate([volume.x[middles(volume)], surface.x]))
    mass = np.zeros_like(stiffness)
    mass[0] = lumped
    return Geometry(
        nodes, d, mass, stiffness, tuple(exchange), lumped, tuple(areas), lumped > 0, volume.x, w, tuple(faces), sight, tuple(depths)
    )  # fmt: skip


def over_depth(beta: float, depth: np.ndarray, conductivity: float) -> np.ndarray:
    """beta of every node over its depth below the surface [W/(m2 K)]."""
    return beta / np.maximum(1.0 + beta * depth / conductivity, LEAST)
