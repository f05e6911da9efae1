"""Paths with mixed control: yield, plastic Poisson ratio, residual of the prescribed stress, dissipation, laws of temperature, failures."""

import math

import numpy as np
import pytest

import mpm
from mpm.scene.point import batch, run_zero

pytestmark = pytest.mark.plain

PULL = [{"strain_rate": {"zz": -0.05}, "stress": {"xx": 0, "yy": 0}}]
HEAT = {"heat": {"fourier": {"kappa": 0, "alpha": 500}}}


def tau(run, axis):
    """Kirchhoff stress along an axis."""
    return run.series[f"stress_{axis}"] * run.series["J_min"]


def test_elastic_slope_and_poisson_ratio(point):
    run = run_zero(point(PULL))
    lam, mu = 2.0e5, 1.0e5
    young, nu = mu * (3 * lam + 2 * mu) / (lam + mu), lam / (2 * (lam + mu))
    axial = run.series["strain_zz"]
    assert np.allclose(tau(run, "zz"), young * axial, rtol=1e-13, atol=0)
    assert np.allclose(run.series["strain_xx"], -nu * axial, rtol=1e-13, atol=0)


@pytest.mark.parametrize("p0", [0.4, 0.5, 0.8, 3.0, 50.0])
def test_uniaxial_yield_and_plastic_poisson_ratio(point, p0):
    run = run_zero(point(PULL, flow={"p0": p0}))
    x = 1 / (9 * p0**2)
    assert abs(tau(run, "zz")[-1]) == pytest.approx(1000 / math.sqrt(1 + x), rel=1e-12)
    plastic = {axis: run.series[f"strain_{axis}"] - run.series[f"strain_elastic_{axis}"] for axis in ("xx", "zz")}
    assert -plastic["xx"][-1] / plastic["zz"][-1] == pytest.approx((0.5 - x) / (1 + x), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("flow", [{"eta": 0}, {"eta": 1e5}, {"eta": 10.0}])
def test_prescribed_stress_is_met_to_round_off(point, flow):
    run = run_zero(point([{"until": 0.4, "stretch_rate": {"zz": -1}, "stress": {"xx": 0, "yy": -250}}, {"stress": {"xx": 0, "yy": 100, "zz": 0}}], flow=flow))
    assert run.outcome.ok, run.outcome
    scale = np.abs(run.series["stress_zz"]).max()
    assert np.abs(run.series["stress_xx"]).max() < 1e-13 * scale
    assert np.abs(run.series["stress_yy"][1:5] + 250).max() < 1e-12 * scale
    assert np.abs(run.series["stress_yy"][5:] - 100).max() < 1e-12 * scale
    assert np.abs(run.series["stress_zz"][5:]).max() < 1e-13 * scale


def test_prescribed_stretch_is_met(point):
    run = run_zero(point([{"until": 0.5, "stretch_rate": {"zz": -0.8, "xx": 0.5}}, {"stretch_rate": {"zz": 0.4}}], flow={}))
    assert np.allclose(np.exp(run.series["strain_zz"]), np.interp(run.times, [0, 0.5, 1], [1, 0.6, 0.8]), rtol=1e-14)
    assert np.allclose(np.exp(run.series["strain_xx"]), np.interp(run.times, [0, 0.5, 1], [1, 1.25, 1.25]), rtol=1e-14)
    assert np.all(run.series["strain_yy"] == 0)


@pytest.mark.parametrize("form", ["radial", "clipped"])
def test_dissipation_never_falls(point, form):
    rng = np.random.default_rng(3)
    many = []
    for _ in range(60):
        stages = [{"until": 0.25 * (k + 1), "strain_rate": dict(zip(("xx", "yy", "zz"), rng.normal(0, 0.2, 3).tolist(), strict=True))} for k in range(4)]
        many.append(point(stages, flow={"map": form, "p0": float(rng.uniform(0.1, 5)), "eta": float(10 ** rng.uniform(0, 6))}, time={"end": 1.0, "step": 0.01}))
    for run in batch(many):
        assert run.outcome.ok
        assert np.all(np.diff(run.series["dissipation_total"]) >= 0)
        assert run.series["energy_elastic"].min() >= 0


def test_laws_follow_a_prescribed_temperature(point):
    M = {"table": {"temperature": [300, 400], "value": [1000, 200]}}
    run = run_zero(point([{"until": 0.2, "strain_rate": {"xx": 0.5, "yy": -0.5}}, {"strain_rate": {"xx": 0.5, "yy": -0.5}, "temperature": 400}],
                         flow={"M": M}, material=HEAT))  # fmt: skip
    assert np.allclose(run.series["kirchhoff_q"][2:], np.interp(run.times[2:], [0.2, 1], [1000, 200]), rtol=1e-12)
    assert np.allclose(run.series["temperature_mean"], np.interp(run.times, [0.2, 1], [300, 400]), rtol=1e-14)
    assert np.allclose(run.series["heat_total"], 1000 * 500 * (run.series["temperature_mean"] - 300), rtol=1e-12, atol=1e-6)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_total"]).max()


def test_steps_are_as_given_or_resolve_the_relaxation(point):
    assert run_zero(point(PULL, flow={"eta": 1e5}, time={"end": 1.0, "step": 0.05})).steps == 20
    fast = min(1e5 / 3e5, 1e5 * 0.64 / (2e5 + 2e5 / 3))
    assert run_zero(point(PULL, flow={"eta": 1e5, "M": 1e9})).steps == pytest.approx(100 / fast, rel=0.05)
    assert run_zero(point(PULL, flow={"eta": 1e5, "M": 1e9}, time={"end": 1.0, "safety": 2})).steps == pytest.approx(50 / fast, rel=0.05)


@pytest.mark.parametrize(
    ("loading", "kind"),
    [
        ([{"stress": {"xx": 0, "yy": 0, "zz": 5000}}], "no_equilibrium"),
        ([{"stretch_rate": {"xx": -2.2}}], "inverted"),
        ([{"strain_rate": {"xx": 5, "yy": 5}}], "overstretched"),
    ],
)
def test_failures_are_outcomes(point, loading, kind):
    run = run_zero(point(loading, flow={}, time={"end": 1.0, "step": 0.1}))
    assert run.outcome.kind == kind
    assert "t = " in run.outcome.message and run.outcome.advice
    assert 1 <= len(run.times) < 11
    assert all(len(values) == len(run.times) for values in run.series.values())


def test_latched_expansion_keeps_what_it_swelled(point):
    material = {**HEAT, "expansion": {"latched": {"gamma": 100, "reference": 300, "set": 350}}}
    free = {"xx": 0, "yy": 0, "zz": 0}
    run = run_zero(point([{"until": 0.5, "temperature": 400, "stress": free}, {"temperature": 300, "stress": free}], material=material))
    bulk = 2e5 + 2e5 / 3
    right = 100 / bulk * np.minimum(np.interp(run.times, [0, 0.25, 1], [0, 50, 50]), 50)
    assert np.allclose(np.log(run.series["J_min"]), right, rtol=1e-12, atol=1e-15)


def test_exchange_that_a_point_does_not_know_is_refused(point):
    with pytest.raises(mpm.ConfigError, match=r"surfaces\.0\.radiation: a material point has no radiation; .*allowed: convection, fixed"):
        point([{}], material=HEAT, bodies={"body": {"shape": {"point": {"surface_to_volume": 10}}, "temperature": 300, "material": "solid"}},
              surfaces=[{"of": "body", "radiation": {"emissivity": 1, "surroundings": 400}}])  # fmt: skip
