"""Scenes of contact against uniaxial flow, balances of momentum, two layers that conduct."""

from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.runner import run_point

SCENES = Path(__file__).parent.parent / "configs" / "scenes"
G = 9.81


def run(name, changes=None):
    found = run_point(mpm.load(SCENES / f"{name}.yaml", changes or {}))
    assert found.outcome.ok, found.outcome
    return found


@pytest.mark.slow
def test_a_press_finds_the_texture_that_its_material_has():
    """Uniaxial, between plates without friction: hardness, cohesiveness and springiness from M, E, p0 and the way down alone."""
    found = run("press_tpa")
    assert not found.facts.get("warnings")
    M, E, p0, A, F = 5e3, 15e3, 0.8, np.pi * 0.012**2, 12 / 20
    tau = M / np.sqrt(1 + 1 / (9 * p0**2))  # Kirchhoff stress of flow
    elastic = tau / E
    plastic = -np.log(F) - elastic
    assert found.finals["hardness_plate"] == pytest.approx(A * tau / F, rel=0.01)
    assert found.finals["springiness_plate"] == pytest.approx((np.exp(-plastic) - F) / (1 - F), rel=0.02)
    assert found.finals["cohesiveness_plate"] == pytest.approx(elastic / 2 / (elastic / 2 + plastic), rel=0.02)


@pytest.mark.slow
def test_a_ball_is_borne_by_what_it_hits():
    """Its speed is the sum of gravity, drag and the slab's push over time, record by record; at the end the slab bears its weight."""
    found = run("ball_on_slab")
    assert not found.facts.get("warnings")
    s, t, m, rate = found.series, found.times, 4 / 3 * np.pi * 0.015**3 * 1000, 10.0
    push = -np.cumsum(s["force_slab_ball_z"] * np.diff(t, prepend=t[0]))
    fallen = s["position_mean_z_ball"] - s["position_mean_z_ball"][0]
    speed = push / m - G * t - rate * fallen  # drag takes rate times the way
    assert speed[-1] == pytest.approx(0.0, abs=5e-3) and np.abs(speed).max() > 0.3
    assert np.trapezoid(speed, t) == pytest.approx(fallen[-1], abs=5e-4)
    assert -s["force_slab_ball_z"][-20:].mean() == pytest.approx(m * G, rel=0.02)


def layers(t, n=60):
    """Temperatures 0.5 mm above and below the faces of the cheese far from its rim [degC]: patty, insulated below, cheese, lid, by volumes on a line."""
    from scipy.linalg import expm

    thick, kappa, capacity = (0.012, 0.003), (0.45, 0.35), (1060 * 3500, 1100 * 2800)
    h = np.repeat(thick, n) / n
    half = 0.5 * h / np.repeat(kappa, n)
    between = 1 / (half[1:] + half[:-1] + np.where(np.arange(1, 2 * n) == n, 1 / 1000, 0.0))
    A = np.diag(between, 1) + np.diag(between, -1)
    A -= np.diag(A.sum(axis=1))
    lid = 1 / (1 / 60 + half[-1])
    A[-1, -1] -= lid
    A /= (h * np.repeat(capacity, n))[:, None]
    start = np.repeat((75.0, 8.0), n) - 95.0
    return np.interp((0.0125, 0.0145), np.cumsum(h) - 0.5 * h, 95.0 + expm(A * t) @ start)


@pytest.mark.slow
def test_cheese_warms_as_two_layers_do():
    """In the middle, to 2 % of the difference at the start, its cells two to the slice; then its rim hangs, and not before it is warm."""
    found = run("burger_cheese")
    assert not found.facts.get("warnings")
    s, t = found.series, found.times
    for when in (40, 60, 90):
        at = np.argmin(np.abs(t - when))
        assert [s["temperature_under"][at] - 273.15, s["temperature_top"][at] - 273.15] == pytest.approx(layers(t[at]), abs=0.02 * 87)
    low = s["position_min_z_cheese"]
    cold = low[t < 30].min()
    assert cold > 9.5e-3 and low[-1] < cold - 3e-3
