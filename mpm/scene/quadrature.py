"""Points of a shape for the total frame: exact over each span between knots of the splines, cut at the surface, with weights above zero.

On a whole span Gauss's n points a direction. Boxes along the grid: the same on what is left of a span. Other shapes: where the exact quadrature of a cut span
(mpm.scene.cut) has weights below zero or many points, as few of points inside as give the same moments, by non-negative least squares (Tchakaloff:
as many as there are moments are enough). Moments: what a gradient of quadratic splines times such a spline holds in a plane, all of degree 2 in a volume.
With them  sum V grad w = int grad w = int w n dA:  a uniform stress balances a traction to round-off, wherever the surface lies in its span.
Fails when   a span holds less than 1e-9 of itself: it is left out
"""

import functools
import itertools

import numpy as np

from mpm.scene import cut as cutting
from mpm.scene.shapes import Box, Cylinder, cut_quadrature

LEAST = 1e-9  # of a span
ORDER = 4  # of the quadrature that gives the moments: products of two quadratic splines, exact on straight sides
FINE = 6  # candidate points a direction of a cut span
RESIDUAL = 1e-10  # of the moments, relative


def knots(lower: np.ndarray, upper: np.ndarray, cell: float, basis: str) -> list[np.ndarray]:
    """Ends of spans around the box, one array a direction: half-way between nodes for quadratic splines, at nodes for the others."""
    shift = 0.5 if basis == "quadratic" else 0.0
    return [(np.arange(np.floor(a / cell - shift + 1e-9), np.ceil(b / cell - shift - 1e-9) + 1) + shift) * cell for a, b in zip(lower, upper, strict=True)]


def points(outline, edges: list[np.ndarray], n: int, radial: bool):
    """(x (Q, d), V (Q,), Surface): quadrature of a shape with Gauss's n points a direction of a whole span; `radial` weighs volume and surface with r."""
    edges = [np.asarray(e, dtype=float) for e in edges]
    if radial and edges[0][0] < 0:
        edges[0] = np.concatenate([[0.0], edges[0][edges[0] > 0]])
    volume, surface = cut_quadrature(outline, edges, ORDER)
    along_grid = (isinstance(outline, Box) and outline.angle == 0.0) or (isinstance(outline, Cylinder) and len(outline.base) == 2) or len(edges) == 1
    x, w = boxed(outline.bounds(), edges, n) if along_grid else thinned(outline, volume, edges, n)
    if radial:
        w, surface = w * x[:, 0], cutting.Surface(surface.x, surface.w * surface.x[:, 0], surface.normal, surface.cell, surface.side)
    return x, w, surface


def boxed(bounds, edges, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points of a box, direction by direction."""
    lines = [spans(a, b, e, n) for a, b, e in zip(*bounds, edges, strict=True)]
    x = np.stack([g.ravel() for g in np.meshgrid(*(one for one, _ in lines), indexing="ij")], axis=-1)
    w = lines[0][1]
    for _, one in lines[1:]:
        w = np.multiply.outer(w, one)
    return x, np.ravel(w)


def spans(lower: float, upper: float, edges: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss's n points and weights on every part of [lower, upper] between edges."""
    a, b = np.maximum(edges[:-1], lower), np.minimum(edges[1:], upper)
    some = b - a > LEAST * np.diff(edges)
    a, b = a[some, None], b[some, None]
    g, gw = cutting.gauss(n)
    return (a + (b - a) * g).ravel(), ((b - a) * gw).ravel()


def exponents(d: int) -> np.ndarray:
    """Powers (M, d) of the moments to keep."""
    if d == 2:
        return np.array([p for p in itertools.product(range(3), repeat=2) if p != (2, 2)])
    return np.array([p for p in itertools.product(range(3), repeat=d) if sum(p) <= 2])


def thinned(outline, volume, edges, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights, cut spans with as few as keep the moments; all weights above zero, all points inside."""
    d, size = len(edges), [len(e) - 1 for e in edges]
    order = np.argsort(volume.cell, kind="stable")
    cells, first, count = np.unique(volume.cell[order], return_index=True, return_counts=True)
    total = np.add.reduceat(volume.w[order], first)
    index = np.stack(np.unravel_index(cells, size), axis=-1)
    lower = np.stack([e[index[:, k]] for k, e in enumerate(edges)], axis=-1)
    upper = np.stack([e[index[:, k] + 1] for k, e in enumerate(edges)], axis=-1)
    filled = total / np.prod(upper - lower, axis=1)
    whole = filled > 1 - LEAST
    g = np.stack(np.meshgrid(*[cutting.gauss(n)[0]] * d, indexing="ij"), axis=-1).reshape(-1, d)
    gw = functools.reduce(np.multiply.outer, [cutting.gauss(n)[1]] * d).ravel()
    kept_x = [(lower[whole, None] + (upper - lower)[whole, None] * g).reshape(-1, d)]
    kept_w = [(np.prod(upper - lower, axis=1)[whole, None] * gw).ravel()]
    for k in np.flatnonzero(~whole & (filled > LEAST)):
        at = order[first[k] : first[k] + count[k]]
        x, w = fewest(outline, volume.x[at], volume.w[at], lower[k], upper[k])
        kept_x.append(x)
        kept_w.append(w)
    return np.concatenate(kept_x), np.concatenate(kept_w)


def fewest(outline, x, w, lower, upper) -> tuple[np.ndarray, np.ndarray]:
    """Points in a cut span with weights above zero and the moments of (x, w): among Gauss points of the span's box of material that lie inside."""
    from scipy.optimize import nnls

    powers, middle, half = exponents(x.shape[1]), 0.5 * (lower + upper), 0.5 * (upper - lower)
    moments = np.prod(((x - middle) / half)[:, None, :] ** powers, axis=2).T @ w
    good = x[w > 0]
    low, high = good.min(axis=0), good.max(axis=0)
    for fine in (FINE, 2 * FINE):
        g = np.polynomial.legendre.leggauss(fine)[0]
        grid = np.stack([a.ravel() for a in np.meshgrid(*(0.5 * (a + b) + 0.5 * (b - a) * g for a, b in zip(low, high, strict=True)), indexing="ij")], axis=-1)
        some = np.concatenate([grid, x])
        some = some[outline.distance(some) <= 1e-12 * half.max()]
        if not len(some):
            continue
        V = np.prod(((some - middle) / half)[:, None, :] ** powers, axis=2).T
        weight, residual = nnls(V, moments)
        used = weight > 0
        if residual <= RESIDUAL * abs(moments[0]):
            return some[used], weight[used]
    if len(some):  # a sliver too thin for its moments: the volume is kept, the rest as near as can be
        return some[used], weight[used] * (moments[0] / weight[used].sum())
    return np.average(x, axis=0, weights=np.abs(w))[None], moments[:1]
