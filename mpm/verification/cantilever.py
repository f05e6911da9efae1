"""A cantilever of Hencky material in plane strain, at rest under its own weight: nine-node elements on a fitted mesh, Newton's method.

int P : grad w dV = int R0 g . w dV,   P = F N diag(2 mu ln s_i/s_i^2) N^T + lam ln J F^-T,   F^T F = N diag(s_i^2) N^T;  held at x = 0, free elsewhere
The volumetric part at 2 x 2 points, all else at 3 x 3: it does not lock as nu goes to 1/2. ELEMENTS over the height, their size by the power GRADED of
the distance from the clamp and from the faces, for the corners of the clamp are singular; the tangent by central differences. Displacement of the small
cantilever differs from that of 20 elements by 9.8e-5, 2.2e-5, 6.1e-6 of it with 8, 12, 16 (nu 0.499: 3.5e-4, 8.1e-5, 2.1e-5):
test_elements_of_the_cantilever_are_enough.
The far cantilever of docs/frames.md drops by 0.50409 of its length; tests/total/finite_elements.py (even elements, 3 x 3 points for all) has 0.50301, 0.50374,
0.50389 with 2, 4 and 6 over its height.
Stress is compared farther than a height from the clamp, where its corners have a singularity that no cell resolves.
Order   1.1 in the cell in the total frame, which is that of the clamp's corners, at nu = 0.499 with F-bar too; the updated frame's error hardly
falls where the body bends far (docs/frames.md), so none is promised there
"""

import functools

import numpy as np

from mpm.verification.setup import at_rest, elastic_only, only_body

ORDER, ORDERS = None, {"total": 1.0}
ELEMENTS, STEPS, MOST_ELEMENTS, GRADED = 16, 6, 400, 3  # elements over the height; load steps; elements along; their size by a power of the distance
SMALL = 1e-6


def stress(F: np.ndarray, lam: float, mu: float, full: bool, bulk: bool) -> np.ndarray:
    """First Piola-Kirchhoff stress (..., 2, 2) of its isochoric-like part 2 mu e (`full`) and of lam ln J (`bulk`)."""
    found = np.zeros_like(F)
    if full:
        square, axes = np.linalg.eigh(np.swapaxes(F, -1, -2) @ F)
        found += mu * F @ ((axes * (np.log(square) / square)[..., None, :]) @ np.swapaxes(axes, -1, -2))
    if bulk:
        found += lam * np.log(np.linalg.det(F))[..., None, None] * np.swapaxes(np.linalg.inv(F), -1, -2)
    return found


def line(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Quadratic shapes (..., 3) on [-1, 1] and their slopes."""
    return np.stack([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2], -1), np.stack([x - 0.5, -2 * x, x + 0.5], -1)


def shapes(s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(shapes (..., 9), slopes (..., 9, 2)) at local coordinates."""
    (a, da), (b, db) = line(s), line(t)
    value = (a[..., :, None] * b[..., None, :]).reshape(*a.shape[:-1], 9)
    slopes = [(x[..., :, None] * y[..., None, :]).reshape(*a.shape[:-1], 9) for x, y in ((da, b), (a, db))]
    return value, np.stack(slopes, -1)


class Mesh:
    """nx x ny elements on [0, length] x [0, height], nodes column by column, the finer the nearer to the corners of the clamp."""

    def __init__(self, length: float, height: float):
        s, near = np.linspace(0, 1, ELEMENTS // 2 + 1) ** GRADED, min(length, height)
        y = np.concatenate([s / 2, 1 - s[-2::-1] / 2]) * height
        x = np.linspace(0, 1, ELEMENTS + 1) ** GRADED * near
        rest = min(MOST_ELEMENTS, round((length - near) / (x[-1] - x[-2])))
        self.edges = (np.concatenate([x, near + (length - near) * np.arange(1, rest + 1) / max(rest, 1)]), y)
        self.nx, self.ny = (len(one) - 1 for one in self.edges)
        wide, high = (np.diff(one) / 2 for one in self.edges)
        self.half = np.stack([np.repeat(wide, self.ny), np.tile(high, self.nx)], axis=-1)  # (E, 2)
        self.columns = 2 * self.ny + 1
        first = (2 * np.arange(self.nx)[:, None] * self.columns + 2 * np.arange(self.ny)).ravel()
        self.nodes = first[:, None] + (np.arange(3)[:, None] * self.columns + np.arange(3)).ravel()
        self.count = (2 * self.nx + 1) * self.columns

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(element (N,), local coordinates (N, 2)) of points."""
        index, local = [], []
        for k, edge in enumerate(self.edges):
            i = np.clip(np.searchsorted(edge, x[:, k], side="right") - 1, 0, len(edge) - 2)
            index.append(i)
            local.append(np.clip(2 * (x[:, k] - edge[i]) / (edge[i + 1] - edge[i]) - 1, -1, 1))
        return index[0] * self.ny + index[1], np.stack(local, axis=-1)

    def gradient(self, u: np.ndarray, element: np.ndarray, local: np.ndarray) -> np.ndarray:
        """F (N, 2, 2) at places in elements."""
        slope = shapes(local[:, 0], local[:, 1])[1] / self.half[element, None]
        return np.eye(2) + np.einsum("nac,nad->ncd", u[self.nodes[element]], slope)


@functools.lru_cache(maxsize=8)
def rest(length: float, height: float, lam: float, mu: float, force: tuple[float, float]) -> tuple[Mesh, np.ndarray]:
    """(mesh, nodal displacements (n, 2)) under a force by reference volume. ArithmeticError where Newton's method does not converge."""
    import scipy.sparse as sparse
    from scipy.sparse.linalg import spsolve

    mesh = Mesh(length, height)
    dofs = (2 * mesh.nodes[:, :, None] + np.arange(2)).reshape(len(mesh.nodes), 18)
    rules, load = [], np.zeros(2 * mesh.count)
    for points, full in ((3, True), (2, False)):
        x, w = np.polynomial.legendre.leggauss(points)
        for s, t, weight in ((x[i], x[j], w[i] * w[j] * mesh.half.prod(axis=1)) for i in range(points) for j in range(points)):
            value, slope = shapes(np.array(s), np.array(t))
            rules.append((weight[:, None, None], slope / mesh.half[:, None], full))
            if full:
                np.add.at(load, dofs.reshape(-1, 9, 2), weight[:, None, None] * value[:, None] * np.array(force))
    free, u = np.arange(2 * mesh.columns, 2 * mesh.count), np.zeros(2 * mesh.count)
    rows, cols = np.repeat(dofs, 18, axis=1).ravel(), np.tile(dofs, (1, 18)).ravel()
    for step in range(1, STEPS + 1):
        for _ in range(30):
            residual, blocks = step / STEPS * load, np.zeros((len(dofs), 18, 18))
            for weight, grad, full in rules:
                F = np.eye(2) + np.einsum("eac,ead->ecd", u[dofs].reshape(-1, 9, 2), grad)
                np.subtract.at(residual, dofs.reshape(-1, 9, 2), weight * np.einsum("ecd,ead->eac", stress(F, lam, mu, full, not full), grad))
                turned = SMALL * np.eye(4).reshape(4, 1, 2, 2)
                A = (stress(F + turned, lam, mu, full, not full) - stress(F - turned, lam, mu, full, not full)) / (2 * SMALL)
                blocks += weight * np.einsum("ebj,cdeij,ead->ebiac", grad, A.reshape(2, 2, len(F), 2, 2), grad, optimize=True).reshape(-1, 18, 18)
            K = sparse.coo_matrix((blocks.ravel(), (rows, cols)), shape=(len(u), len(u))).tocsr()[free][:, free]
            change = spsolve(K.tocsc(), residual[free])
            u[free] += change
            if np.abs(change).max() < 1e-9 * length:
                break
        else:
            raise ArithmeticError("Newton's method does not converge")
    return mesh, u.reshape(-1, 2)


def kirchhoff(mesh: Mesh, u: np.ndarray, x: np.ndarray, lam: float, mu: float) -> np.ndarray:
    """Kirchhoff stress (N, 4) at points: xx, yy, zz, xy. ln J is that of the 2 x 2 points of the element, continued linearly in each direction."""
    element, local = mesh.at(x)
    F = mesh.gradient(u, element, local)
    g = 1 / np.sqrt(3)
    corner = np.array([[s, t] for s in (-g, g) for t in (-g, g)])
    held = np.stack([np.log(np.linalg.det(mesh.gradient(u, element, np.tile(place, (len(x), 1))))) for place in corner], axis=1)
    weight = np.prod((1 + np.sign(corner)[None] * local[:, None] / g) / 2, axis=2)
    tau = stress(F, lam, mu, True, False) @ np.swapaxes(F, 1, 2) + (lam * np.sum(weight * held, axis=1))[:, None, None] * np.eye(2)
    return np.stack([tau[:, 0, 0], tau[:, 1, 1], lam * np.sum(weight * held, axis=1), tau[:, 0, 1]], axis=1)


def exact(experiment):
    """The state at rest: displacement, the drop of the tip, and stress away from the clamp, compared at the end."""
    _, body = only_body(experiment)
    held = getattr(experiment.walls.get("left"), "kind", "")
    if experiment.grid.dimension != 2 or len(experiment.bodies) != 1 or type(body.shape).kind != "box" or body.shape.angle or any(experiment.method.offset):
        raise ValueError("cantilever needs one box in grid.dimension 2, and no offset")
    lower, upper = np.array(body.shape.lower), np.array(body.shape.upper)
    if lower[0] != 0 or held != "stick" or upper[0] >= experiment.grid.size[0] or not experiment.gravity or any(load.traction for load in experiment.loads):
        raise ValueError("cantilever needs a box from walls: {left: stick} that ends in the domain, gravity, and no traction")
    elastic, density = elastic_only(experiment, body, gravity=True)
    (length, height), lam, mu = (upper - lower).tolist(), elastic.lam, elastic.mu
    mesh, u = rest(length, height, lam, mu, tuple(density * g for g in experiment.gravity))

    def displacement(X):
        element, local = mesh.at(X - lower)
        return np.einsum("na,nac->nc", shapes(local[:, 0], local[:, 1])[0], u[mesh.nodes[element]])

    return at_rest(displacement, lambda X: kirchhoff(mesh, u, X - lower, lam, mu), lambda X: X[:, 0] > height)
