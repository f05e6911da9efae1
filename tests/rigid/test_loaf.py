"""Zhang & Datta's loaf at the fitted parameters, against the measured curve and against finite volumes written here, which share nothing with mpm."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import erf

import mpm
from mpm.materials.laws import Bump
from mpm.rigid import Method, RigidBody, solve
from mpm.scene import Cylinder
from mpm.sweep.cases import plan

SCENE = Path(__file__).parents[2] / "configs" / "scenes" / "loaf.yaml"

RADIUS, HEIGHT, DENSITY, KAPPA, BETA, START, OVEN = 0.036, 0.035, 301.0, 0.35, 13.1, 297.15, 463.15
BASE, LATENT, BOILING, WIDTH = 2247.0, 2.46e5, 372.75, 1.5
MEASURED = np.genfromtxt(Path(__file__).parents[1] / "reference" / "zhang-datta-2006.csv", delimiter=",", comments="#")[1:]


def loaf(cell, method=None, beta=BETA):
    """Base at z = 4 mm; probes at mid height, on the axis and 2 mm under the crust."""
    alpha = Bump(BASE, LATENT, BOILING, WIDTH)
    body = RigidBody(Cylinder(RADIUS, HEIGHT, (0.0, 0.004)), START, DENSITY, KAPPA, alpha, (("all", beta, OVEN),))
    probes = {"centre": [0.0, 0.0215], "crust": [0.034, 0.0215]}
    return solve([body], "axisymmetric", cell, end=780.0, times=np.arange(0, 781, 10.0), probes=probes, thresholds=[("centre", 368.15)], method=method)


def finite_volumes(cell, kappa=KAPPA, beta=BETA):
    """Nodal enthalpy in cells of the cylinder, explicit Euler at 0.8 of its limit: time of 95 degC at the centre, and both probes by the minute [degC]."""
    nr, nz = round(RADIUS / cell), round(HEIGHT / cell)
    dr, dz = RADIUS / nr, HEIGHT / nz
    r, face = (np.arange(nr) + 0.5) * dr, np.arange(1, nr) * dr
    z = (np.arange(nz) + 0.5) * dz
    volume = (r * dr * dz)[:, None]
    theta = np.linspace(START - 20, OVEN + 20, 200_001)
    h = BASE * theta + 0.5 * LATENT * (1 + erf((theta - BOILING) / (WIDTH * np.sqrt(2))))
    state = np.full((nr, nz), np.interp(START, theta, h))
    side, cap = (beta / (1 + beta * d / 2 / kappa) for d in (dr, dz))
    dt = 0.8 * DENSITY * BASE / (2 * kappa * (1 / dr**2 + 1 / dz**2))
    steps = int(np.ceil(780 / dt))
    dt = 780 / steps
    weights = [np.maximum(0, 1 - np.abs(z - 0.0175) / dz), np.maximum(0, 1 - np.abs(r - 0.034) / dr)]
    centre, crust = np.empty(steps + 1), np.empty(steps + 1)
    for n in range(steps + 1):
        now = np.interp(state, h, theta)
        axis = (9 * now[0] - now[1]) / 8  # even in r
        centre[n], crust[n] = axis @ weights[0], weights[1] @ now @ weights[0]
        radial = kappa * np.diff(now, axis=0) / dr * (face * dz)[:, None]
        axial = kappa * np.diff(now, axis=1) / dz * (r * dr)[:, None]
        gain = np.zeros_like(now)
        gain[:-1] += radial
        gain[1:] -= radial
        gain[:, :-1] += axial
        gain[:, 1:] -= axial
        gain[-1] += side * (OVEN - now[-1]) * RADIUS * dz
        gain[:, 0] += cap * (OVEN - now[:, 0]) * r * dr
        gain[:, -1] += cap * (OVEN - now[:, -1]) * r * dr
        state += dt * gain / (DENSITY * volume)
    time = np.linspace(0, 780, steps + 1)
    minutes = 60.0 * np.arange(1, 14)
    return np.interp(368.15, centre, time), np.interp(minutes, time, centre) - 273.15, np.interp(minutes, time, crust) - 273.15


def by_the_minute(run):
    at = 60.0 * np.arange(1, 14)
    return [np.interp(at, run.times, run.series[f"temperature.{p}"]) - 273.15 for p in ("centre", "crust")]


def test_against_the_measured_curve():
    """2.5 and 5 degC root mean square are asked for; the fit gives 2.2 and 4.5."""
    run = loaf(1e-3)
    for found, column, bound in zip(by_the_minute(run), (1, 2), (2.5, 5.0), strict=True):
        assert np.sqrt(np.mean((found - MEASURED[:, column]) ** 2)) < bound
    assert run.unknowns == 1482
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * run.series["heat_exchanged"][-1]


def test_time_to_95_converges_with_the_cell():
    times = [loaf(cell).crossings["centre", 368.15] for cell in (2e-3, 1e-3, 0.5e-3)]
    assert times[2] == pytest.approx(688.8, abs=1.5)
    assert times[1] == pytest.approx(688.8, abs=4)
    assert abs(times[2] - times[1]) < 0.5 * abs(times[1] - times[0])


@pytest.mark.parametrize("cell", [0.7e-3, 0.5e-3])
def test_time_to_95_to_three_thousandths(cell):
    """687.8 and 688.6 s, 0.18 and 0.06 % early, where 689 s to 0.3 % are asked."""
    assert loaf(cell).crossings["centre", 368.15] == pytest.approx(689.0, rel=3e-3)


def test_against_finite_volumes():
    time, centre, crust = finite_volumes(1e-3)
    run = loaf(0.5e-3)
    assert time == pytest.approx(687.0, abs=0.7)
    assert run.crossings["centre", 368.15] == pytest.approx(time, abs=2.5)
    for found, exact in zip(by_the_minute(run), (centre, crust), strict=True):
        np.testing.assert_allclose(found, exact, atol=0.9)


@pytest.mark.slow
def test_against_fine_finite_volumes():
    time, centre, crust = finite_volumes(0.5e-3)
    run = loaf(0.5e-3)
    assert run.crossings["centre", 368.15] == pytest.approx(time, abs=1.5)
    for found, exact in zip(by_the_minute(run), (centre, crust), strict=True):
        np.testing.assert_allclose(found, exact, atol=0.5)


@pytest.mark.slow
def test_the_shipped_sweep():
    """All 18 points at the scene's own cell and tolerance, against finite volumes at 1 and 0.5 mm, extrapolated: what the head of the scene says."""
    for case in plan(mpm.load(SCENE)).cases:
        found = mpm.run_point(case.experiment).finals["time_to_centre_95_degC"]
        kappa, beta = (case.values[path] for path in ("materials.dough.heat.fourier.kappa", "surfaces.0.convection.beta"))
        (coarse, ends, _), (fine, end, _) = (finite_volumes(cell, kappa, beta) for cell in (1e-3, 0.5e-3))
        if end[-1] + (end[-1] - ends[-1]) / 3 < 95:
            assert np.isnan(found), case.values
        else:
            assert found == pytest.approx(fine + (fine - coarse) / 3, rel=4e-3), case.values


def test_methods_agree():
    """Three integrators of the same equations: the step is not what limits."""
    times = [loaf(2e-3, Method(kind, order, 1e-4)).crossings["centre", 368.15] for kind, order in (("explicit", 4), ("implicit", 4), ("implicit", 2))]
    np.testing.assert_allclose(times, times[0], atol=0.3)


def test_a_sticky_surface_is_stepped_implicitly():
    """beta = inf: `auto` counts operations and leaves the explicit method."""
    run = loaf(2e-3, beta=np.inf)
    assert run.facts["heat_method"] == ["NewtonSteps"]
    assert run.crossings["centre", 368.15] < 300
