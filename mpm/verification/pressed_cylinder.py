"""A long thick cylinder under pressures by present area inside and outside, in plane strain and at rest, at any strain that Hencky's law bears.

dP_r/dR + (P_r - P_t)/R = 0,  P_r = tau_r/l_r,  tau_r = 2 mu ln l_r + lam ln(l_r l_t),  l_r = dr/dR, l_t = r/R, and t as r;  P_r = -p l_t on either side.
Solved for the displacement by collocation (SciPy's solve_bvp), from Lamé's solution on (S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed. 1970,
section 28), which it is at small strain:  u = B R + C/R,  (lam + mu) B = (p_i a^2 - p_o b^2)/(2 (b^2 - a^2)),  mu C = (p_i - p_o) a^2 b^2/(2 (b^2 - a^2)).
Order   2 in the cell in the total frame; in the updated one displacement of about 1, and stress in the cells that the surface cuts is off by a part of itself,
        as on a free curved surface (docs/frames.md)
"""

import functools

import numpy as np

from mpm.verification.setup import at_rest, elastic_only, only_body

ORDER, ORDERS = 0.6, {"total": 1.8}
LINE, TOLERANCE = 201, 1e-9  # points of the first guess; of the residual


def lame(a: float, b: float, lam: float, mu: float, inside: float, outside: float):
    """Lamé's (u, du/dR) over R."""
    share = 2 * (b**2 - a**2)
    B, C = (inside * a**2 - outside * b**2) / share / (lam + mu), (inside - outside) * a**2 * b**2 / share / mu
    return lambda R: np.stack([B * R + C / R, B - C / R**2])


@functools.lru_cache(maxsize=8)
def widened(a: float, b: float, lam: float, mu: float, inside: float, outside: float):
    """R -> (u, du/dR), u by the pressure p over M: linear in small ones. ValueError where there is no such shape."""
    from scipy.integrate import solve_bvp

    scale = max(abs(inside), abs(outside)) / (lam + 2 * mu)
    first = lame(a, b, lam, mu, inside, outside)

    def stretches(R, y):
        return np.log1p(scale * y[1]), np.log1p(scale * y[0] / R)

    def stresses(R, y):
        er, et = stretches(R, y)
        return (2 * mu * er + lam * (er + et)) * np.exp(-er), (2 * mu * et + lam * (er + et)) * np.exp(-et)

    def slopes(R, y):
        (er, et), (Pr, Pt) = stretches(R, y), stresses(R, y)
        stiff = (lam + 2 * mu) * np.exp(-2 * er) - Pr * np.exp(-er)
        turn = lam * np.exp(-er - et) * (y[1] - y[0] / R)
        return np.stack([y[1], -((Pr - Pt) / scale + turn) / R / stiff])

    def ends(ya, yb):
        left = [(stresses(R, y)[0] + p * (1 + scale * y[0] / R)) / scale / (lam + 2 * mu) for R, y, p in ((a, ya, inside), (b, yb, outside))]
        return np.array(left)

    line = np.linspace(a, b, LINE)
    with np.errstate(invalid="ignore"):
        found = solve_bvp(slopes, ends, line, first(line) / scale, tol=TOLERANCE, max_nodes=20_000)
    if not found.success:
        raise ValueError("pressed_cylinder finds no shape at rest under these pressures: Hencky's law may not bear them")
    return lambda R: scale * found.sol(R)


def cylinder(experiment):
    """(a, b, centre) of a ring in the plane, or of a box from the bottom to the top between walls that slip."""
    _, body = only_body(experiment)
    kind, flat = type(body.shape).kind, experiment.grid.dimension == 2
    if len(experiment.bodies) != 1 or (kind, experiment.grid.dimension) not in (("ring", 2), ("box", "axisymmetric")) or any(experiment.method.offset):
        raise ValueError("pressed_cylinder needs one ring in grid.dimension 2, or one box in axisymmetric, and no offset")
    if flat:
        return body.shape.inner, body.shape.outer, np.array(body.shape.centre)
    (a, low), (b, high), height = body.shape.lower, body.shape.upper, experiment.grid.size[1]
    if not a > 0 or low != 0 or abs(high - height) > 1e-9 * height or any(wall.acts != "slip" for wall in experiment.walls.values()):
        raise ValueError("pressed_cylinder needs a hollow cylinder from the bottom to the top of the domain, both walls slip")
    return a, b, None


def exact(experiment):
    """Displacement and stress at rest under pressures on the sides inner and outer."""
    _, body = only_body(experiment)
    a, b, centre = cylinder(experiment)
    elastic, _ = elastic_only(experiment, body)
    lam, mu, pressures = elastic.lam, elastic.mu, {"inner": 0.0, "outer": 0.0}
    for load in experiment.loads:
        if load.traction is not None and (load.side not in pressures or load.traction.pressure is None):
            raise ValueError("pressed_cylinder needs tractions of the form pressure, on the sides inner and outer alone")
        if load.traction is not None:
            pressures[load.side] += load.traction.pressure
    if not any(pressures.values()):
        raise ValueError("pressed_cylinder needs a pressure on the side inner or outer")
    shape = widened(a, b, lam, mu, pressures["inner"], pressures["outer"])

    def polar(X):
        out = X - centre if centre is not None else X * [1, 0]
        R = np.linalg.norm(out, axis=1)
        return R, out / R[:, None]

    def displacement(X):
        R, out = polar(X)
        return shape(R)[0][:, None] * out

    def stress(X):
        R, (x, y) = polar(X)[0], polar(X)[1].T
        u, slope = shape(R)
        er, et = np.log1p(slope), np.log1p(u / R)
        radial, hoop, along = 2 * mu * er + lam * (er + et), 2 * mu * et + lam * (er + et), lam * (er + et)
        if centre is None:
            return np.stack([radial, along, hoop, 0 * R], axis=1)
        return np.stack([radial * x * x + hoop * y * y, radial * y * y + hoop * x * x, along, (radial - hoop) * x * y], axis=1)

    return at_rest(displacement, stress)
