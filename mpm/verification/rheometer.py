"""Reading M, p0 and eta from a compression test, as from a rheometer's curve (docs/physics.md 5.4; scene configs/scenes/dough_rheometer.yaml).

What is read: axial stress, axial and lateral strain over time; nothing of the config. Compression at zero lateral stress, then a hold.
E, nu    slopes of the first sample: before yield
hold     with the axial strain held, tau relaxes as tau_y + c exp(-t/T),  tau_y = M/sqrt(1 + x),  T = eta/(E (1 + x)),  x = 1/(9 p0^2)
p0       lateral over axial plastic strain in the hold is -nu_p,  p0 = (1/3) sqrt((1 + nu_p)/(1/2 - nu_p))
creep    the same from a disc of particles under a constant load (configs/scenes/dough_creep.yaml): `creep`
Good     within 1 % with 100 steps a relaxation time and a hold of two or more; fails when the hold shows no relaxation (eta = 0: p0 and M are still read)
"""

import math
from typing import NamedTuple

import numpy as np


class Reading(NamedTuple):
    """Parameters read from a curve."""

    E: float  # [Pa]
    nu: float
    M: float  # [Pa]
    p0: float
    eta: float  # [Pa s]; 0 where nothing relaxes


def read(times, stress, axial, lateral, hold: float) -> Reading:
    """From samples (T,) of time [s], axial Cauchy stress [Pa], axial and lateral Hencky strain; the hold begins at `hold` [s]."""
    times, stress, axial, lateral = (np.asarray(values, dtype=float) for values in (times, stress, axial, lateral))
    tau = stress * np.exp(axial + 2 * lateral)
    E, nu = tau[1] / axial[1], -lateral[1] / axial[1]
    flowing = np.flatnonzero((times > times[1]) & (times <= hold * (1 + 1e-12)))
    held = np.flatnonzero(times >= hold * (1 - 1e-12))
    plastic_axial, plastic_lateral = axial - tau / E, lateral + nu * tau / E
    span = flowing[len(flowing) // 2 :]
    ratio = -np.polyfit(plastic_axial[span], plastic_lateral[span], 1)[0]
    p0 = math.sqrt((1 + ratio) / (0.5 - ratio)) / 3
    x = 1 / (9 * p0**2)
    limit, decay = fade(times[held], tau[held])
    return Reading(E, nu, abs(limit) * math.sqrt(1 + x), p0, decay * E * (1 + x))


def fade(times: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Limit and time constant of values that approach the limit exponentially; samples at equal times: each is a line in the one before."""
    if np.ptp(values) <= 1e-9 * np.abs(values).max():
        return float(values[-1]), 0.0
    share, rest = np.polyfit(values[:-1], values[1:], 1)
    return rest / (1 - share), -(times[1] - times[0]) / math.log(share)


def read_run(run, hold: float) -> Reading:
    """From a Run of the scene: compression along z, free along x and y."""
    return read(run.times, run.series["stress_zz"], run.series["strain_zz"], run.series["strain_xx"], hold)


def creep(times, traction, axial, lateral) -> Reading:
    """From a disc under a nominal load that rises and stays: samples (T,) of time [s], axial nominal traction [Pa], axial and lateral Hencky strain.

    tau = traction exp(axial) in uniaxial stress, and past yield the axial plastic strain grows at (1 + x)(tau - tau_y)/eta: a line in tau, which falls as the
    disc does. E, nu from where the load is below a third; the line and nu_p from where the load no longer rises.
    """
    times, traction, axial, lateral = (np.asarray(values, dtype=float) for values in (times, traction, axial, lateral))
    tau, full = traction * np.exp(axial), np.abs(traction) >= np.abs(traction).max() * (1 - 1e-9)
    first = (np.abs(traction) < 0.34 * np.abs(traction).max()) & (traction != 0)
    E = float(tau[first] @ axial[first] / (axial[first] @ axial[first]))
    nu = float(-(lateral[first] @ axial[first]) / (axial[first] @ axial[first]))
    plastic_axial, plastic_lateral = axial - tau / E, lateral + nu * tau / E
    ratio = -np.polyfit(plastic_axial[full], plastic_lateral[full], 1)[0]
    p0 = math.sqrt((1 + ratio) / (0.5 - ratio)) / 3
    x = 1 / (9 * p0**2)
    inner = np.flatnonzero(full)[1:-1]
    rate = (plastic_axial[inner + 1] - plastic_axial[inner - 1]) / (times[inner + 1] - times[inner - 1])
    slope, intercept = np.polyfit(tau[inner], rate, 1)
    return Reading(E, nu, abs(intercept / slope) * math.sqrt(1 + x), p0, (1 + x) / slope)


def creep_run(run, experiment) -> Reading:
    """From a Run of configs/scenes/dough_creep.yaml: strains of the disc as a whole, by the mean height and radius of its mass."""
    from mpm.integrate.traction import risen

    (load,) = experiment.loads
    traction = np.array([load.traction.nominal[-1] * risen(t, load.traction.ramp) for t in run.times])
    height, radius = run.series["position_mean_z"], run.series["position_mean_r"]
    return creep(run.times, traction, np.log(height / height[0]), np.log(radius / radius[0]))
