"""A linear thermoelastic wave between insulated walls (docs/physics.md 7, problem 6): numerical damping shows here first.

u = U sin kX, theta = T cos kX:  U' = V,  V' = -M k^2/R0 U + gamma k/R0 T,  T' = -gamma Theta_0 k/(R0 alpha) V - kappa k^2/(R0 alpha) T,  M = lam + 2 mu.
Frequency and damping of a run are those of a exp(-s t) cos(omega t) + b exp(-s t) sin(omega t) + c exp(-r t), fitted to U(t).
At 64 cells apic/apic (velocity/temperature) keeps both best, -0.03 % and -0.2 %; pic has ten times the damping: `python -m mpm.benchmarks.wave`.
Order   2 in the cell
"""

import math

import numpy as np

from mpm.error import Motion
from mpm.verification.setup import constants, line_box

ORDER = 1.8


def rates(experiment) -> tuple[np.ndarray, float]:
    """The matrix of (U, V, T), and k."""
    from mpm.scene.law import elastic_law, stress_temperature_modulus

    body, lower, length = line_box(experiment)
    material = experiment.materials[body.material]
    if lower != 0 or abs(length - experiment.grid.size[0]) > 1e-9 * length or experiment.surfaces or material.flow is not None:
        raise ValueError("standing_wave needs an insulated box that fills the domain, and no flow")
    if material.expansion is None or material.heating is None or material.heating.elastic is None or body.temperature != material.expansion.reference:
        raise ValueError("standing_wave needs expansion, heating.elastic, and the reference temperature at the start")
    kappa, _ = constants(experiment, body)
    elastic, R0, alpha = elastic_law(material.elastic), material.density, float(material.heat.alpha.value)
    gamma, k = stress_temperature_modulus(material.expansion, elastic), math.pi / length
    M = elastic.lam + 2 * elastic.mu
    heat = R0 * alpha
    return np.array([[0, 1, 0], [-M * k**2 / R0, 0, gamma * k / R0], [0, -gamma * body.temperature * k / heat, -kappa * k**2 / heat]]), k


def fit(times: np.ndarray, U: np.ndarray, guess: np.ndarray) -> np.ndarray:
    """(s, omega, r) of a run."""
    from scipy.optimize import least_squares

    def residual(p):
        wave = np.exp(-p[0] * times)
        basis = np.stack([wave * np.cos(p[1] * times), wave * np.sin(p[1] * times), np.exp(-p[2] * times)], axis=1)
        return (basis @ np.linalg.lstsq(basis, U, rcond=None)[0] - U) / np.abs(U).max()

    return least_squares(residual, guess, x_scale=np.abs(guess), xtol=1e-12, ftol=1e-12, gtol=1e-12).x


def exact(experiment):
    """Displacement, velocity, temperature; amplitudes over time; error_frequency and error_damping of the run."""
    A, k = rates(experiment)
    values, vectors = np.linalg.eig(A)
    weights = np.linalg.solve(vectors, np.array([0, experiment.exact.amplitude, 0], complex))
    wave = values[np.argmax(values.imag)]
    slow = values[np.argmin(np.abs(values.imag))]
    true = np.array([-wave.real, wave.imag, -slow.real])
    (body,) = experiment.bodies.values()

    def state(t):
        return (vectors @ (weights * np.exp(values * t))).real

    def start(one):
        p = one.particles
        p.C[:, 0, 0] = experiment.exact.amplitude * k * np.cos(k * p.x[:, 0])
        p.v[:, 0] = experiment.exact.amplitude * np.sin(k * p.x[:, 0])
        return one

    def measure(X, V, found, t):
        s, c = np.sin(k * X[:, 0]), np.cos(k * X[:, 0])
        warm = found["temperature"][:, 0] - body.temperature
        return {"amplitude_displacement": V @ (s * found["displacement"][:, 0]) / (V @ s**2), "amplitude_temperature": V @ (c * warm) / (V @ c**2)}

    def conclude(times, series):
        if len(times) < 12:
            return {"error_frequency": math.nan, "error_damping": math.nan}
        found = fit(times, series["amplitude_displacement"], true)
        return {"error_frequency": found[1] / true[1] - 1, "error_damping": found[0] / true[0] - 1}

    fields = {
        "displacement": lambda X, t: state(t)[0] * np.sin(k * X[:, 0]),
        "velocity": lambda X, t: state(t)[1] * np.sin(k * X[:, 0]),
        "temperature": lambda X, t: body.temperature + state(t)[2] * np.cos(k * X[:, 0]),
    }
    return Motion(fields, start, measure, conclude)
