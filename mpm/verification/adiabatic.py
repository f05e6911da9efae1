"""Adiabatic compression of a thermoelastic point (docs/physics.md 7, problem 3).

Theta = Theta(0) J^-Gamma,  Gamma = gamma/(R0 alpha):  local heating is the exact adiabat, so any step gives it.
Order   exact in any step (round-off)
"""

import numpy as np

from mpm.verification.path import constant, point, strains

ORDER = None


def exact(experiment):
    """t -> {temperature}: all strains prescribed, no flow, no exchange, constant alpha."""
    from mpm.scene.law import elastic_law, stress_temperature_modulus

    body, material = point(experiment)
    if material.expansion is None or material.heating is None or material.heating.elastic is None or material.flow is not None or experiment.surfaces:
        raise ValueError("adiabatic needs elastic, expansion and heating.elastic, and neither flow nor surfaces")
    gamma = stress_temperature_modulus(material.expansion, elastic_law(material.elastic))
    exponent = gamma / (material.density * constant(material.heat.alpha, "alpha"))

    def solution(times: np.ndarray) -> dict[str, np.ndarray]:
        trace = strains(experiment, times).sum(axis=1)
        return {"temperature_mean": body.temperature * np.exp(-exponent * (trace - strains(experiment, np.zeros(1)).sum()))}

    return solution
