"""What the exact solutions need to know of a scene, and refusals where the scene is not their problem."""

import math

import numpy as np


def only_body(experiment):
    """The body that the exact solution is about."""
    name = experiment.exact.body or next(iter(experiment.bodies))
    return name, experiment.bodies[name]


def constants(experiment, body) -> tuple[float, float]:
    """kappa and diffusivity; both must be constant."""
    material = experiment.materials[body.material]
    kappa, alpha = material.heat.kappa, material.heat.alpha
    for name, law in (("kappa", kappa), ("alpha", alpha)):
        if type(law).kind != "constant":
            raise ValueError(f"the exact solution needs a constant {name}, not a {type(law).kind}")
    return float(kappa.value), float(kappa.value) / (material.density * float(alpha.value))


def one_exchange(experiment, name: str, *sides: str) -> tuple[float, float]:
    """beta and the temperature outside; one convection or fixed temperature, constant in time, must act on one of `sides` (all), and nothing elsewhere."""
    entries = [surface for surface in experiment.surfaces if surface.of == name]
    if len(entries) != 1 or entries[0].side not in (sides or ("all",)):
        raise ValueError(f"the exact solution needs one surface entry of {name}, with side {' or '.join(sides or ('all',))}")
    entry = entries[0]
    if entry.flux is not None or entry.radiation is not None or (entry.convection is None) == (entry.fixed is None):
        raise ValueError("the exact solution needs convection or a fixed temperature, and nothing else")
    beta, out = (entry.convection.beta, entry.convection.outside) if entry.fixed is None else (math.inf, entry.fixed.temperature)
    if not isinstance(out, float) or not isinstance(beta, float) or getattr(entry, "from") or entry.until is not None:
        raise ValueError("the exact solution needs a beta and a temperature outside that do not change over time")
    by_itself(experiment, name)
    return beta, out


def by_itself(experiment, name: str) -> None:
    """ValueError where walls or tools exchange heat, or another body lies so near that it may."""
    from mpm.scene.shapes import shape

    if any(getattr(one, "heat", None) is not None for one in (*experiment.walls.values(), *experiment.tools.values())):
        raise ValueError("the exact solution knows no hot walls and tools")
    dimension = experiment.grid.dimension
    boxes = {other: shape(body.shape, dimension).bounds() for other, body in experiment.bodies.items()} if dimension != 0 else {}
    for other, (low, high) in boxes.items():
        if other != name and all(np.maximum(low, boxes[name][0]) - np.minimum(high, boxes[name][1]) < experiment.grid.cell):
            raise ValueError(f"the exact solution is of {name} by itself, and {other} lies beside it")


def moved(experiment, point) -> np.ndarray:
    """A point of the config in the grid's coordinates: bodies are shifted by method.offset."""
    return np.array(point, dtype=float) + np.array(experiment.method.offset) * experiment.grid.cell


def series(roots: np.ndarray, coefficients: np.ndarray, shape, hot: float, out: float, length: float, diffusivity: float):
    """theta(s, t) = out + (hot - out) sum C_n exp(-z_n^2 D t/L^2) shape(z_n s/L)."""

    def theta(s: np.ndarray, t: float) -> np.ndarray:
        if t <= 0:
            return np.full(len(s), hot)
        fourier = diffusivity * t / length**2
        seen = roots**2 * fourier < 40 * math.log(10)
        return out + (hot - out) * (shape(np.multiply.outer(s / length, roots[seen])) @ (coefficients[seen] * np.exp(-(roots[seen] ** 2) * fourier)))

    return theta


def bisected(function, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Roots of a function that crosses zero once between each pair of bounds."""
    rises = function(high) > function(low)
    for _ in range(60):
        middle = 0.5 * (low + high)
        below = (function(middle) < 0) == rises
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def line_box(experiment):
    """(body, lower end, length) of the only body, a box in 1-D at no offset."""
    _, body = only_body(experiment)
    if len(experiment.bodies) != 1 or experiment.grid.dimension != 1 or type(body.shape).kind != "box" or any(experiment.method.offset):
        raise ValueError("the exact solution needs one box in grid.dimension 1, and no offset")
    return body, body.shape.lower[0], body.shape.upper[0] - body.shape.lower[0]


def elastic_only(experiment, body, gravity: bool = False):
    """(Hencky's law, density) of a body that neither flows nor expands."""
    from mpm.scene.law import elastic_law

    material = experiment.materials[body.material]
    hencky = material.elastic is not None and material.elastic.kind == "hencky"
    if not hencky or material.flow is not None or material.expansion is not None or (experiment.gravity is not None and not gravity):
        raise ValueError("the exact solution needs a body with elastic: hencky, without flow and expansion" + ("" if gravity else ", and no gravity"))
    return elastic_law(material.elastic), material.density


def at_rest(displacement, stress, where=None, start=None):
    """A Motion that is compared where it has come to rest, at the end of the run: displacement(X) (N, D), stress(X) (N, K) as mpm.error has them.

    Relative errors of both, root mean squares; those of stress over the particles where(X) alone. error_stress_max [Pa] is that of the worst of them.
    """
    from mpm.error import Motion

    def mean(values, V):
        return float(np.sqrt(V @ np.sum(values**2, axis=1) / V.sum()))

    def measure(X, V, found, t):
        kept = np.ones(len(X), bool) if where is None else where(X)
        u, tau = displacement(X), stress(X[kept])
        wrong, stray = found["displacement"] - u, found["stress"][kept] - tau
        sizes.update(displacement=mean(u, V), stress=mean(tau, V[kept]))
        return {"error_displacement_l2": mean(wrong, V), "error_stress_l2": mean(stray, V[kept]), "error_stress_max": float(np.sqrt(np.sum(stray**2, 1)).max())}

    def conclude(times, series):
        return {f"error_{name}": float(series[f"error_{name}_l2"][-1]) / size for name, size in sizes.items()}

    sizes: dict[str, float] = {}
    return Motion({}, start, measure, conclude, observed=("displacement", "stress"))
