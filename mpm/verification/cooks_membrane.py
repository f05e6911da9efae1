"""Cook's membrane: a tapered panel, clamped at its left, sheared along its right end; the static deflection of its tip (docs/physics.md 15, mode 11).

Corners (0, 0), (48, 44), (48, 60), (0, 44); nominal traction (0, T) on the right; plane strain, nu near 1/2: where volumetric locking shows.
There is no closed form. The reference is linear elasticity by 9-node elements on a mesh of ELEMENTS x ELEMENTS, exact to 1e-3 of the tip's deflection
(0.02 % from 32 to 64 elements at nu = 0.499; by the same elements 23.96 for the plane stress of R. D. Cook, J. Struct. Div. ASCE 100 (1974) 1851:
E = 1, nu = 1/3, T = 1/16, where the literature has 23.96). It holds for small deflections: a load that bends the tip by more than 1 % is refused.
Finals    error_tip, relative; error_displacement, of the whole field, relative, at the end of the run
Order     in the cell with F-bar about 1: the corner at the clamped top is singular; without F-bar cells lock until they are small
"""

import functools

import numpy as np

from mpm.error import Motion
from mpm.verification.setup import only_body

ORDER = 0.9
CORNERS = np.array([[0.0, 0.0], [48.0, 44.0], [48.0, 60.0], [0.0, 44.0]])
TIP = np.array([48.0, 52.0])
ELEMENTS = 32


def shapes(s: np.ndarray, t: np.ndarray):
    """Values (Q, 9) and derivatives (Q, 9, 2) of the 9-node element on [-1, 1]^2; node 3 i + j at (i - 1, j - 1)."""

    def line(x):
        return np.stack([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2], axis=1), np.stack([x - 0.5, -2 * x, x + 0.5], axis=1)

    (a, da), (b, db) = line(s), line(t)
    value = (a[:, :, None] * b[:, None, :]).reshape(-1, 9)
    slopes = (da[:, :, None] * b[:, None, :]).reshape(-1, 9), (a[:, :, None] * db[:, None, :]).reshape(-1, 9)
    return value, np.stack(slopes, axis=2)


def corner_map(s, t):
    """Position (Q, 2) and its derivatives (Q, 2, 2) by (s, t) in [0, 1]^2, bilinear between the corners."""
    p, q = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t], axis=1), np.stack([t - 1, 1 - t, t, -t], axis=1)
    r = np.stack([s - 1, -s, s, 1 - s], axis=1)
    return p @ CORNERS, np.stack([q @ CORNERS, r @ CORNERS], axis=2)


@functools.lru_cache(maxsize=4)
def static(lam: float, mu: float, n: int = ELEMENTS) -> np.ndarray:
    """Nodal displacements (2 n + 1, 2 n + 1, 2) under T = 1 along y, Lame constants of plane strain; the volumetric part at 2 x 2 points (no locking)."""
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    nodes = 2 * n + 1
    first = (2 * np.arange(n)[:, None] * nodes + 2 * np.arange(n)).reshape(-1)  # lower left node of an element
    local = (np.arange(3)[:, None] * nodes + np.arange(3)).reshape(-1)
    dofs = (2 * (first[:, None] + local)[:, :, None] + np.arange(2)).reshape(n * n, 18)
    corner = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), axis=-1).reshape(-1, 2) / n
    K = np.zeros((n * n, 18, 18))
    for count, volumetric in ((3, False), (2, True)):
        x, w = np.polynomial.legendre.leggauss(count)
        for i in range(count):
            for j in range(count):
                _, slope = shapes(x[i : i + 1], x[j : j + 1])
                place = corner + (np.array([x[i], x[j]]) + 1) / (2 * n)
                _, J = corner_map(place[:, 0], place[:, 1])
                J = J / (2 * n)
                grad = np.einsum("ak,ekc->eac", slope[0], np.linalg.inv(J))
                weight = w[i] * w[j] * np.linalg.det(J)
                if volumetric:
                    div = grad.reshape(n * n, 18)
                    K += lam * np.einsum("e,ea,eb->eab", weight, div, div)
                    continue
                same = np.einsum("eac,ebc->eab", grad, grad)
                turn = np.einsum("eac,ebd->eadbc", grad, grad)  # d_c N_a d_d N_b couples u_a along d with u_b along c
                K += mu * np.einsum("e,eab->eab", weight, turn.reshape(n * n, 18, 18))
                for c in range(2):
                    K[:, c::2, c::2] += mu * weight[:, None, None] * same
    rows, columns = np.repeat(dofs, 18, axis=1).reshape(-1), np.tile(dofs, (1, 18)).reshape(-1)
    total = coo_array((K.reshape(-1), (rows, columns)), shape=(2 * nodes**2, 2 * nodes**2)).tocsr()
    load = np.zeros(2 * nodes**2)
    side = (2 * n * nodes + np.arange(nodes)) * 2 + 1
    for e in range(n):
        load[side[2 * e : 2 * e + 3]] += 16.0 / n * np.array([1, 4, 1]) / 6
    free = np.arange(2 * nodes, 2 * nodes**2)  # the left end is the first row of nodes
    u = np.zeros(2 * nodes**2)
    u[free] = spsolve(total[free][:, free].tocsc(), load[free])
    return u.reshape(nodes, nodes, 2)


def deflection(u: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Displacement (N, 2) at positions X (N, 2) in the membrane."""
    n = (u.shape[0] - 1) // 2
    s = X[:, 0] / 48.0
    low, high = 44.0 * s, 44.0 + 16.0 * s
    t = (X[:, 1] - low) / (high - low)
    where = np.clip(np.stack([s, t], axis=1) * n, 0, n)
    element = np.minimum(where.astype(int), n - 1)
    inside = 2 * (where - element) - 1
    value, _ = shapes(inside[:, 0], inside[:, 1])
    found = np.zeros_like(X)
    for a in range(9):
        found += value[:, a, None] * u[2 * element[:, 0] + a // 3, 2 * element[:, 1] + a % 3]
    return found


def exact(experiment):
    """The static answer under the config's load; tip_displacement and the error of the field over time."""
    from mpm.scene.law import elastic_law

    _, body = only_body(experiment)
    if experiment.grid.dimension != 2 or len(experiment.bodies) != 1 or type(body.shape).kind != "polygon":
        raise ValueError("cooks_membrane needs one polygon in grid.dimension 2")
    vertices = np.array(body.shape.vertices)
    if vertices.shape != CORNERS.shape or np.abs(vertices - vertices[0] - CORNERS).max() > 1e-9 or vertices[0, 0] != 0 or any(experiment.method.offset):
        raise ValueError("cooks_membrane needs the corners (0, y), (48, y + 44), (48, y + 60), (0, y + 44) in this order, and no offset")
    material, held = experiment.materials[body.material], getattr(experiment.walls.get("left"), "kind", "")
    if material.flow is not None or material.expansion is not None or experiment.gravity is not None or held != "stick":
        raise ValueError("cooks_membrane needs an elastic body without flow, expansion and gravity, and walls: {left: stick}")
    tractions = [load for load in experiment.loads if load.traction is not None]
    if len(tractions) != 1 or tractions[0].side != "right" or (tractions[0].traction.nominal or [1])[0] != 0:
        raise ValueError("cooks_membrane needs one traction, upwards or downwards, on side right")
    elastic = elastic_law(material.elastic)
    u = static(elastic.lam, elastic.mu) * tractions[0].traction.nominal[1]
    tip = float(deflection(u, TIP[None])[0, 1])
    if abs(tip) > 0.01 * TIP[0]:
        raise ValueError(f"cooks_membrane is for small deflections: this load bends the tip by {tip:.3g} m, more than 1 % of its 48 m")

    size = float(np.sqrt(np.mean(np.sum(u**2, axis=2))))

    def measure(X, V, found, t):
        X = X - vertices[0]
        wrong = found["displacement"] - deflection(u, X)
        near = np.argsort(np.sum((X - TIP) ** 2, axis=1))[:9]
        plane = np.linalg.lstsq(np.column_stack([np.ones(9), X[near] - TIP]), found["displacement"][near, 1], rcond=None)[0]
        return {"tip_displacement": plane[0], "error_displacement_l2": np.sqrt(V @ np.sum(wrong**2, axis=1) / V.sum())}

    def conclude(times, series):
        return {"error_tip": float(series["tip_displacement"][-1]) / tip - 1, "error_displacement": float(series["error_displacement_l2"][-1]) / size}

    return Motion({}, None, measure, conclude, observed=("displacement",))
