"""A ball at rest between a floor and a plate: Hertz's force over approach, and what it leaves out, the compression of the ball as a whole.

d = 3 (1 - nu^2) F/(4 E a) - f F/(pi E)   approach at either face, half of the plate's way
a^3 = 3 (1 - nu^2) R F/(4 E)              radius of the contact
f = 2 (1 + nu) R^2/l^3 + (1 - nu^2)/l, l^2 = a^2 + 4 R^2
H. Hertz, J. reine angew. Math. 92 (1882) 156: the first term; Y. Tatara, J. Eng. Mater. Technol. 113 (1991) 285: the second, 0.55 a/R of the force.
Both are of small strain, and leave out what is of order (a/R)^2.

Errors  error_force: of the plate's mean force over the last interval of records
Order   none: the formula has an error of its own
"""

import math

from mpm.error import Motion
from mpm.verification.setup import elastic_only, only_body

ORDER = None


def approach(F: float, E: float, nu: float, R: float) -> float:
    """d at the force F."""
    a = math.cbrt(3 * (1 - nu**2) * R * F / (4 * E))
    reach = math.hypot(a, 2 * R)
    f = 2 * (1 + nu) * R**2 / reach**3 + (1 - nu**2) / reach
    return 3 * (1 - nu**2) * F / (4 * E * a) - f * F / (math.pi * E)


def force(d: float, E: float, nu: float, R: float) -> float:
    """F at the approach d at either face, with the ball's own compression; Hertz's is 4/3 E/(1 - nu^2) sqrt(R d^3)."""
    from scipy.optimize import brentq

    hertz = 4 / 3 * E / (1 - nu**2) * math.sqrt(R * d**3)
    return float(brentq(lambda F: approach(F, E, nu, R) - d, 0.5 * hertz, 2 * hertz))


def exact(experiment):
    """Force between plates: one elastic ball that lies on a floor of contact without friction and touches the only tool, a cylinder that goes down."""
    _, body = only_body(experiment)
    law, _ = elastic_only(experiment, body)
    floor, tools = experiment.walls.get("bottom"), experiment.tools
    if experiment.grid.dimension != "axisymmetric" or type(body.shape).kind != "ball" or len(experiment.bodies) != 1 or any(experiment.method.offset):
        raise ValueError("hertz needs one ball in grid.dimension axisymmetric, and no offset")
    R, height = body.shape.radius, body.shape.centre[1]
    if floor is None or type(floor).kind != "contact" or floor.friction != 0 or abs(height - R) > 1e-9 * R or experiment.gravity is not None:
        raise ValueError("hertz needs a ball that lies on a wall `contact` without friction at the bottom, and no gravity")
    plate, tool = next(iter(tools.items()), ("", None))
    if len(tools) != 1 or type(tool.shape).kind != "cylinder" or tool.friction != 0 or abs(tool.shape.base[1] - 2 * R) > 1e-9 * R:
        raise ValueError("hertz needs one tool, a cylinder without friction whose base lies on the ball")
    mu = law.mu
    nu = law.lam / (2 * (law.lam + mu))

    def conclude(times, series):
        d = -0.5 * float(series[f"travel_{plate}_z"][-1])
        found = -2 * math.pi * float(series[f"force_{plate}_z"][-1])  # a run counts it by radian
        return {"error_force": abs(found / force(d, 2 * mu * (1 + nu), nu, R) - 1) if d > 0 else math.nan}

    return Motion({}, conclude=conclude)
