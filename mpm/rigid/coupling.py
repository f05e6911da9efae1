"""Heat through the surface that two bodies share, in the weak form (docs/physics.md 12): for any conductance H, perfect contact too.

    [v] = v_a - v_b,   F(v) = w_a kappa_a dn v_a + w_b kappa_b dn v_b,   n outward of a,   r = 1/H
    sum over cells of the surface: int c2 [u][v] - c1 (F(u)[v] + [u] F(v)) - c3 F(u) F(v),    c1, c2, c3 = (1, tau, r)/(1 + r tau)

Nitsche's method (r = 0) continued to finite H as Juntunen & Stenberg 2009 do for Robin conditions: consistent, so the order of the splines is kept, and
neither a large H nor perfect contact locks the splines of a curved or tilted surface, as a penalty would.
Weights and tau follow what a cut leaves of a cell (Annavarapu, Hautefeuille & Dolbow 2012): with C the largest of int (dn v)^2 over int |grad v|^2 of a cell,
w_a = s_a/(s_a + s_b), s = 1/(kappa C), tau = SAFE/(s_a + s_b): positive definite for SAFE > 1 however small a cut is, without a parameter.
"""

import numpy as np

from mpm.rigid.geometry import ORDER, Geometry, on_axis
from mpm.rigid.nodes import Nodes, make_nodes
from mpm.rigid.touching import patch

SAFE = 2.0
DEEP = (1e-7, 0.1)  # cells below the surface where its cell is looked for: the second where a cut has left nothing
TINY = 1e-12  # of the largest eigenvalue
BLUNT = 100.0  # kappa/h over the conductance that stands for perfect contact where kappa follows temperature


def cells_of(nodes: Nodes, x: np.ndarray) -> np.ndarray:
    """Cells (between knots) of points (P, d), counted from the first of the box."""
    d = x.shape[1]
    return np.floor((x - nodes.origin[:d]) / nodes.h + 0.5).astype(np.int64) - nodes.first[:d] - 1


def splines(nodes: Nodes, x: np.ndarray, cell: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes (m,), values (P, m) and gradients (P, m, d) at points x (P, d) of the splines that live in one `cell` (d,)."""
    d = x.shape[1]
    f = (x - nodes.origin[:d]) / nodes.h - nodes.first[:d] - 1 - cell
    n = np.stack([0.5 * (0.5 - f) ** 2, 0.75 - f * f, 0.5 * (0.5 + f) ** 2], axis=-1)  # (P, d, 3)
    dn = np.stack([f - 0.5, -2.0 * f, f + 0.5], axis=-1) / nodes.h
    local = nodes.local[:, :d]
    each = np.stack([n[:, k][:, local[:, k]] for k in range(d)], axis=-1)  # (P, m, d)
    slopes = np.stack([dn[:, k][:, local[:, k]] for k in range(d)], axis=-1)
    gradient = np.stack([slopes[..., k] * np.prod(np.delete(each, k, axis=-1), axis=-1) for k in range(d)], axis=-1)
    return (cell + local) @ nodes.stride[:d], each.prod(axis=-1), gradient


class Side:
    """One of the two bodies: what its splines know of the cells at the surface."""

    def __init__(self, shaped: Geometry, kappa: float):
        self.nodes, self.kappa, self.shaped = shaped.nodes, kappa, shaped
        cell = cells_of(self.nodes, shaped.x)
        order = np.lexsort(cell.T[::-1])
        found, first = np.unique(cell[order], axis=0, return_index=True)
        self.points = {tuple(c): order[a:b] for c, a, b in zip(found.tolist(), first, [*first[1:], len(order)], strict=True)}

    def homes(self, x: np.ndarray, inward: np.ndarray) -> np.ndarray:
        """Cells (S, d) of this body at the points x (S, d) of its surface."""
        home = cells_of(self.nodes, x + DEEP[0] * self.nodes.h * inward)
        lost = np.array([tuple(c) not in self.points for c in home.tolist()], dtype=bool)
        home[lost] = cells_of(self.nodes, x[lost] + DEEP[1] * self.nodes.h * inward[lost])
        for at, c in zip(x, home.tolist(), strict=True):
            if tuple(c) not in self.points:
                place = ", ".join(f"{1e3 * one:.4g}" for one in at)
                raise ValueError(f"near ({place}) mm less than a tenth of a cell of material lies behind a surface in contact: take a smaller grid.cell")
        return home

    def trace(self, cell: np.ndarray, w: np.ndarray, normal_slope: np.ndarray) -> float:
        """C of a cell [1/m]: largest int (dn v)^2 over the surface, over int |grad v|^2 in the cell."""
        mine = self.points[tuple(cell.tolist())]
        _, _, gradient = splines(self.nodes, self.shaped.x[mine], cell)
        inside = np.einsum("q,qad,qbd->ab", self.shaped.w[mine], gradient, gradient)
        size, mode = np.linalg.eigh(inside)
        white = mode / np.sqrt(np.maximum(size, TINY * size[-1]))
        return float(np.linalg.eigvalsh(white.T @ (normal_slope.T * w) @ normal_slope @ white)[-1])


def couple(one, two, shapes, conductance: float, axisymmetric: bool, h: float, blunt: bool):
    """Triplets (row, column, value) of the symmetric matrix that joins two bodies, and (number, value) of the heat that leaves the first [W].

    one, two: (Geometry, kappa, into (N,)): the body's number of each of its nodes becomes into[number]; shapes of both; blunt: a conductance alone, where
    kappa follows temperature.
    """
    sides, into = [Side(shaped, kappa) for shaped, kappa, _ in (one, two)], (one[2], two[2])
    lower, upper = (np.array(bound, dtype=float) for bound in shapes[0].bounds())
    origin = sides[0].nodes.origin[: len(lower)]
    lower[0] = max(lower[0], 0.0) if axisymmetric else lower[0]
    x, w, normal = patch(*shapes, on_axis(make_nodes(lower, upper, h, origin)[1], axisymmetric), ORDER, h)
    w = w * x[:, 0] if axisymmetric else w
    homes = np.concatenate([sides[0].homes(x, -normal), sides[1].homes(x, normal)], axis=1)
    found, group = np.unique(homes, axis=0, return_inverse=True)
    order = np.argsort(group.ravel(), kind="stable")
    ends = np.searchsorted(group.ravel()[order], np.arange(len(found) + 1))
    rows, columns, values, nodes, leaving = [], [], [], [], []
    d, r = x.shape[1], 0.0 if np.isinf(conductance) else 1.0 / conductance
    for cell, first, last in zip(found, ends, ends[1:], strict=False):
        q = order[first:last]
        (index_a, value_a, slope_a), (index_b, value_b, slope_b) = (splines(s.nodes, x[q], c) for s, c in zip(sides, (cell[:d], cell[d:]), strict=True))
        slope_a, slope_b = (np.einsum("qad,qd->qa", slope, normal[q]) for slope in (slope_a, slope_b))
        jump = np.concatenate([value_a, -value_b], axis=1)
        if blunt:
            h_c = 1.0 / (r + h / (BLUNT * max(s.kappa for s in sides)))
            flux, c1, c2, c3 = np.zeros_like(jump), 0.0, h_c, 0.0
        else:
            s_a, s_b = (1.0 / (s.kappa * s.trace(c, w[q], slope)) for s, c, slope in zip(sides, (cell[:d], cell[d:]), (slope_a, slope_b), strict=True))
            share, tau = s_a / (s_a + s_b), SAFE / (s_a + s_b)
            flux = np.concatenate([share * sides[0].kappa * slope_a, (1 - share) * sides[1].kappa * slope_b], axis=1)
            c1, c2, c3 = np.array([1.0, tau, r]) / (1.0 + r * tau)
        both = (jump.T * w[q]) @ (c2 * jump - c1 * flux) - (flux.T * w[q]) @ (c1 * jump + c3 * flux)
        index = np.concatenate([into[0][index_a], into[1][index_b]])
        rows.append(np.repeat(index, len(index)))
        columns.append(np.tile(index, len(index)))
        values.append(both.ravel())
        nodes.append(index)
        leaving.append(w[q] @ (c2 * jump - c1 * flux))
    return tuple(np.concatenate(part) for part in (rows, columns, values)), tuple(np.concatenate(part) for part in (nodes, leaving))
