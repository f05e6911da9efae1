"""Thermal expansion of an elastic point, free in n of its three directions and held in the others (docs/physics.md 7, problem 4).

Free directions strain by e = gamma (Theta - Theta_0)/(2 mu + n lam): n = 3 free, 2 plane strain, 1 uniaxial, 0 clamped. Kirchhoff stress of a held one:
lam n e - gamma (Theta - Theta_0).
Order   exact in any step (round-off)
"""

import numpy as np

from mpm.verification.path import AXES, point, temperatures

ORDER = None


def exact(experiment):
    """t -> {strains, stresses}: one stage with its temperature prescribed, every direction free (stress 0) or held."""
    from mpm.scene.law import elastic_law, stress_temperature_modulus

    body, material = point(experiment)
    if material.expansion is None or material.flow is not None or len(experiment.loading) != 1:
        raise ValueError("thermal_expansion needs elastic and expansion, no flow, and a loading of one stage")
    stage, elastic = experiment.loading[0], elastic_law(material.elastic)
    if body.temperature != material.expansion.reference or any(getattr(body.shape.strain, axis) for axis in AXES):
        raise ValueError("thermal_expansion starts without stress: at the reference temperature of the expansion, without strain")
    if any(getattr(part, axis) for part in (stage.strain_rate, stage.stretch_rate, stage.stress) for axis in AXES):
        raise ValueError("thermal_expansion needs each direction free (stress 0) or held")
    free = np.array([getattr(stage.stress, axis) is not None for axis in AXES])
    gamma = stress_temperature_modulus(material.expansion, elastic)

    def solution(times: np.ndarray) -> dict[str, np.ndarray]:
        push = gamma * (temperatures(experiment, times) - material.expansion.reference)
        e = push / (2 * elastic.mu + free.sum() * elastic.lam)
        J = np.exp(free.sum() * e)
        held = (elastic.lam * free.sum() * e - push) / J
        values = {f"strain_{axis}": e * free[k] for k, axis in enumerate(AXES)}
        return values | {f"stress_{axis}": held * ~free[k] for k, axis in enumerate(AXES)}

    return solution
