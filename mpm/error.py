"""How far a run of moving bodies is from an exact solution that is known by material point: `Motion`, and the errors that a run records.

A motion gives fields of the position X at the start and the time: displacement and velocity (N, D), stress (N, K) (Kirchhoff), temperature (N,).
Series    error_<field>_l2 and error_<field>_max (temperature: error_l2, error_max), weighted with the reference volume
Finals    error_<field>: root mean square of the error over the root mean square of the field, over all times and particles; temperature from its zero
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from mpm.diagnostics import stresses, temperatures, thermal_pressure
from mpm.heat.setting import conditions

PLACES = {3: ((0, 0), (1, 1), (2, 2)), 4: ((0, 0), (1, 1), (2, 2), (0, 1)), 6: ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))}


@dataclass(frozen=True)
class Motion:
    """An exact solution by material point.

    fields    name -> f(X (N, D), t)
    start     start(body) -> body: what a config cannot say, fields at the start and sources; the body arrives in its reference state
    measure   measure(X, V (N,), found, t) -> {series: value} of the observed fields `found`; conclude(times, series) -> {final: value}
    observed  fields beside those compared that `measure` wants
    """

    fields: Mapping[str, Callable]
    start: Callable | None = None
    measure: Callable | None = None
    conclude: Callable | None = None
    observed: tuple[str, ...] = ()

    def begin(self, body):
        """(the body at the start, the Errors that will follow it)."""
        errors = Errors(self, body.particles.x.astype(float))
        return (body if self.start is None else self.start(body)), errors


def kirchhoff(body) -> np.ndarray:
    """Kirchhoff stress (N, K) [Pa], components as B has them (mpm.state)."""
    B = body.particles.B.astype(float)
    places = PLACES[B.shape[1]]
    full = np.tile(np.eye(3), (len(B), 1, 1))
    for k, (i, j) in enumerate(places):
        full[:, i, j] += B[:, k]
        full[:, j, i] = full[:, i, j]
    values, axes = np.linalg.eigh(full)
    tau = stresses(body.elastic, 0.5 * np.log(values), thermal_pressure(body), conditions(body))
    tensor = np.einsum("nik,nk,njk->nij", axes, tau, axes)
    return np.stack([tensor[:, i, j] for i, j in places], axis=1)


OBSERVED = {
    "displacement": lambda body, X: body.particles.x - X,
    "velocity": lambda body, X: body.particles.v,
    "stress": lambda body, X: kirchhoff(body),
    "temperature": lambda body, X: temperatures(body),
}


@dataclass
class Errors:
    """Errors of one body, gathered over a run."""

    motion: Motion
    X: np.ndarray
    sums: dict[str, list[float]] = field(default_factory=dict)  # field -> [error squared, field squared]

    def series(self, body, t: float) -> dict[str, float]:
        """One line of every series."""
        V, found, values = body.particles.V0.astype(float), {}, {}
        for name in (*self.motion.fields, *self.motion.observed):
            found[name] = np.asarray(OBSERVED[name](body, self.X), float).reshape(len(V), -1)
        for name, exact in self.motion.fields.items():
            wanted = np.asarray(exact(self.X, t), float).reshape(len(V), -1)
            error = np.sum((found[name] - wanted) ** 2, axis=1)
            square = float(np.sum(V * error) / np.sum(V))
            kept = self.sums.setdefault(name, [0.0, 0.0])
            kept[0] += square
            kept[1] += float(np.sum(V * np.sum(wanted**2, axis=1)) / np.sum(V))
            prefix = "error" if name == "temperature" else f"error_{name}"
            values[f"{prefix}_l2"], values[f"{prefix}_max"] = math.sqrt(square), math.sqrt(float(np.max(error)))
        if self.motion.measure is not None:
            values |= self.motion.measure(self.X, V, found, t)
        return values

    def finals(self, times, series) -> dict[str, float]:
        """Relative errors over the run; of a field that should be zero, the error itself."""
        ratios = {f"error_{name}": math.sqrt(wrong / norm) if norm > 0 else math.sqrt(wrong / len(times)) for name, (wrong, norm) in self.sums.items()}
        return ratios | (self.motion.conclude(times, series) if self.motion.conclude is not None else {})
