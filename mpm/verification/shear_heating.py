"""Adiabatic heating of a point that is sheared past its yield stress (docs/physics.md 7, problem 8).

Isochoric stretching without pressure, rate-independent flow: Theta = Theta(0) + chi_d M (eps_eq - M/(3 mu))/(R0 alpha) past yield,
eps_eq = sqrt(2/3) |eps| the equivalent strain;  q = min(3 mu eps_eq, M).
Order   exact in any step (round-off)
"""

import numpy as np

from mpm.verification.path import constant, point, strains

ORDER = None


def exact(experiment):
    """t -> {temperature, Kirchhoff q}: one stage of isochoric strain rates, eta = 0, no expansion, no exchange."""
    from mpm.scene.law import elastic_law

    body, material = point(experiment)
    if material.flow is None or material.heating is None or material.heating.dissipation is None or material.expansion is not None or experiment.surfaces:
        raise ValueError("shear_heating needs elastic, flow, heat and heating.dissipation, and neither expansion nor surfaces")
    if constant(material.flow.eta, "eta") != 0 or len(experiment.loading) != 1 or experiment.loading[0].temperature is not None:
        raise ValueError("shear_heating needs eta = 0 and a loading of one stage that leaves the temperature free")
    mu, M = elastic_law(material.elastic).mu, constant(material.flow.M, "M")
    rise = material.heating.dissipation.fraction * M / (material.density * constant(material.heat.alpha, "alpha"))

    def solution(times: np.ndarray) -> dict[str, np.ndarray]:
        e = strains(experiment, times)
        if np.abs(e.sum(axis=1)).max() > 1e-14:
            raise ValueError("shear_heating needs strain rates that add up to zero")
        equivalent = np.sqrt(2 / 3) * np.linalg.norm(e, axis=1)
        heated = body.temperature + rise * np.maximum(equivalent - M / (3 * mu), 0.0)
        return {"temperature_mean": heated, "kirchhoff_q": np.minimum(3 * mu * equivalent, M)}

    return solution
