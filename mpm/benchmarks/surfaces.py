"""Three ways to exchange heat at a free surface, on bodies at rest (docs/physics.md 3, 10 and 11). `python -m mpm.benchmarks.surfaces` prints the table.

exact     from the boundary particle, corrected to the surface: w~ = w + grad(w) (x_s - x_p). What moving bodies use (mpm.integrate.surface_flux)
depth     at the boundary particle, through the layer above it: w, and beta/(1 + beta d/kappa), d = V/(2 S)
samples   massless points on the surface itself: w(x_s)

The same cut cells, APIC transfer and steps for all, 2 particles a cell and direction; backward Euler of 0.0375 h^2 where the error is asked (so that the step
adds little), by sparse LU. `explicit`: the longest stable explicit step 2/lambda over h^2, least of the offsets; samples reach nodes that no particle does, and
those have no capacity: an explicit step has nothing to put their heat in (its share is given as `lost`), an implicit one carries them as massless unknowns.

Measured (configs/verification/surfaces.md). Depth is of order 1 everywhere; behind beta = inf its explicit step is 28 times longer.
Samples are as exact as `exact` while every node they reach has a particle. Where the shape ends in a sliver too thin for one (offset 0.503), massless nodes
take on the surface temperature by themselves, and the body hardly cools: errors of 0.1 that fall with order 0.5. They win nowhere.
"""

from dataclasses import dataclass

import numpy as np

WAYS = ("exact", "depth", "samples")
PACE, END, PENALTY = 0.0375, 0.2, 1e3
OFFSETS = (0.0, 0.15, 0.3, 0.45, 0.503)  # the last leaves slivers that are too thin for a particle
HEAD = "| body | Bi | way | error | at three cells | order | explicit | lost |\n|---|---|---|---|---|---|---|---|\n"


def splines(x, h: float, shape, centre=None):
    """(index, w, grad) of the quadratic splines at points x (P, D), flat over `shape` nodes: (P, 3^D), (P, 3^D), (P, 3^D, D). centre: whose nodes are taken."""
    base = np.floor((x if centre is None else centre) / h + 0.5).astype(int) - 1
    f = x / h - base - 1
    one = np.stack([0.5 * (0.5 - f) ** 2, 0.75 - f * f, 0.5 * (0.5 + f) ** 2], axis=-1)
    slope = np.stack([f - 0.5, -2 * f, f + 0.5], axis=-1) / h
    D = x.shape[1]
    place = np.stack(np.meshgrid(*[np.arange(3)] * D, indexing="ij"), axis=-1).reshape(-1, D)
    index = np.ravel_multi_index([base[:, k, None] + place[:, k] for k in range(D)], shape)
    parts = [one[:, k][:, place[:, k]] for k in range(D)]
    w = np.prod(parts, axis=0)
    grad = np.stack([np.prod([slope[:, j][:, place[:, j]] if j == k else parts[j] for j in range(D)], axis=0) for k in range(D)], axis=-1)
    return index, w, grad


def matrix(index, values, nodes: int):
    """A row a point."""
    from scipy.sparse import csr_matrix

    rows = np.repeat(np.arange(len(index)), index.shape[1])
    return csr_matrix((values.ravel(), (rows, index.ravel())), shape=(len(index), nodes))


@dataclass
class Body:
    """Transfers and operators of one body at rest, unit density, kappa and alpha."""

    W: object
    slopes: list  # of theta at the particles, a direction each: 4/h^2 sum w d
    shifts: list  # w d, a direction each
    V: np.ndarray
    capacity: np.ndarray
    conduction: object
    surface: object  # T (S, nodes)
    strength: np.ndarray  # S beta (S,)


def make(outline, h: float, biot: float, way: str, size: float) -> tuple[Body, np.ndarray]:
    """Cut cells of `outline`, the exchange done in one `way`: (Body, particle positions)."""
    from mpm.scene.shapes import cells

    lower, upper = outline.bounds()
    edges = [np.arange(np.floor(2 * low / h), np.ceil(2 * high / h) + 1) * h / 2 for low, high in zip(lower, upper, strict=True)]
    cut = cells(outline, edges)
    shape = tuple([round(size / h) + 1] * len(lower))
    nodes = int(np.prod(shape))
    x, V, o = cut.centroid, cut.volume, cut.owner
    index, w, grad = splines(x, h, shape)
    away = np.stack(np.unravel_index(index, shape), axis=-1) * h - x[:, None]
    W = matrix(index, w, nodes)
    G = [matrix(index, grad[..., k], nodes) for k in range(x.shape[1])]
    shifts = [matrix(index, w * away[..., k], nodes) for k in range(x.shape[1])]
    beta = biot if np.isfinite(biot) else PENALTY / h
    if way == "exact":
        T = matrix(index[o], w[o] + np.einsum("sak,sk->sa", grad[o], cut.point - x[o]), nodes)
    elif way == "samples":
        at, there, _ = splines(cut.point, h, shape)
        T = matrix(at, there, nodes)
    else:
        T = matrix(index[o], w[o], nodes)
        beta = (biot if np.isfinite(biot) else 1e12) / (1 + (biot if np.isfinite(biot) else 1e12) * V[o] / (2 * np.bincount(o, cut.area, len(V))[o]))
    capacity = W.T @ V
    return Body(W, [4 / h**2 * s for s in shifts], shifts, V, capacity, sum(g.T.multiply(V) @ g for g in G), T, beta * cut.area), x


def cooled(body: Body, dt: float, steps: int) -> np.ndarray:
    """Particle temperatures after backward Euler steps from 1, in air of 0."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import splu

    A = body.conduction + body.surface.T.multiply(body.strength) @ body.surface
    used = np.flatnonzero(np.asarray(abs(A).sum(axis=1)).ravel() > 0)
    C = body.capacity[used]
    A = A.tocsr()[used][:, used]
    solver = splu((diags(C + 1e-13 * C.max()) + dt * A).tocsc())
    theta, slopes = np.ones(len(body.V)), [np.zeros(len(body.V)) for _ in body.shifts]
    full = np.zeros(len(body.capacity))
    for _ in range(steps):
        heat = body.W.T @ (body.V * theta) + sum(s.T @ (body.V * c) for s, c in zip(body.shifts, slopes, strict=True))
        full[:] = 0.0
        full[used] = solver.solve(heat[used])
        theta, slopes = body.W @ full, [s @ full for s in body.slopes]
    return theta


def stable(body: Body, h: float) -> tuple[float, float]:
    """Longest explicit step over h^2, and the share of the surface's exchange that falls on nodes without capacity."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import eigsh

    A = (body.conduction + body.surface.T.multiply(body.strength) @ body.surface).tocsr()
    held = np.flatnonzero(body.capacity > 1e-14 * body.capacity.max())
    root = diags(body.capacity[held] ** -0.5)
    largest = float(eigsh(root @ A[held][:, held] @ root, k=1, return_eigenvectors=False, tol=1e-6)[0])
    pull = body.surface.T @ body.strength
    return 2 / largest / h**2, 1 - float(pull[held].sum() / pull.sum())


def case(kind: str, biot: float, way: str, n: int) -> tuple[float, float, float]:
    """(worst error, least explicit step, largest lost share) of the offsets, n cells to the half-thickness or radius 1."""
    from scipy.special import j0, j1

    from mpm.scene import Ball, Box
    from mpm.verification import robin_cylinder, robin_slab
    from mpm.verification.setup import series

    if kind == "slab":
        z = robin_slab.roots(biot)
        theta = series(z, 4 * np.sin(z) / (2 * z + np.sin(2 * z)), np.cos, 1.0, 0.0, 1.0, 1.0)
    else:
        z = robin_cylinder.roots(biot)
        theta = series(z, 2 * j1(z) / (z * (j0(z) ** 2 + j1(z) ** 2)), j0, 1.0, 0.0, 1.0, 1.0)
    worst, least, lost, h = 0.0, np.inf, 0.0, 1 / n
    steps = int(np.ceil(END / (PACE * h * h)))
    for offset in OFFSETS if kind == "slab" else OFFSETS[2:3]:  # a disc has every offset on its rim
        middle = 1.5 + offset * h
        outline = Box((middle - 1,), (middle + 1,)) if kind == "slab" else Ball((middle, 1.5 - 0.1 * h), 1.0)
        body, x = make(outline, h, biot, way, 3.0)
        centre = np.array([middle] if kind == "slab" else [middle, 1.5 - 0.1 * h])
        wrong = cooled(body, END / steps, steps) - theta(np.linalg.norm(x - centre, axis=1), END)
        limit, share = stable(body, h)
        worst, least, lost = max(worst, float(np.sqrt(np.average(wrong**2, weights=body.V)))), min(least, limit), max(lost, share)
    return worst, least, lost


def table(kinds=("slab", "disc"), biots=(1.0, 10.0, np.inf), cells=None) -> str:
    """Every body, Biot number and way."""
    rows = []
    for kind in kinds:
        sizes = cells or ((8, 16, 32) if kind == "slab" else (6, 12, 24))
        for biot in biots:
            for way in WAYS:
                found = [case(kind, biot, way, n) for n in sizes]
                errors = [one[0] for one in found]
                order = -np.polyfit(np.log(sizes), np.log(errors), 1)[0]
                rows.append(f"| {kind} | {biot:g} | {way} | n = {', '.join(map(str, sizes))} | {', '.join(f'{e:.2g}' for e in errors)} | {order:.2f} "
                            f"| {min(one[1] for one in found):.2g} | {100 * max(one[2] for one in found):.2g} % |")  # fmt: skip
    return HEAD + "\n".join(rows) + "\n"


TITLE = """# Three ways to exchange heat at a free surface

Made by `python -m mpm.benchmarks.surfaces > configs/verification/surfaces.md`; ways and columns are explained at the head of `mpm/benchmarks/surfaces.py`.

"""

if __name__ == "__main__":
    print(TITLE + table(), end="")
