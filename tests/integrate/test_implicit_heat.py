"""Implicit heat of moving bodies: exact series, any beta, the ledger, walls, laws of temperature. The material is the common one, whose coupling is zero."""

import numpy as np
import pytest

import mpm
from mpm.verification import exact_solution

END, INF = 0.2, float("inf")
IMPLICIT, SECOND, EXPLICIT = {"implicit": {}}, {"implicit": {"order": 2}}, {"explicit": {}}


def slab(core, biot, n, offset=0.3, heat=IMPLICIT, speed=1.0, step="auto", surface=None, **material):
    """Half-thickness 1, n cells to it, thrown across the grid."""
    h = 1 / n
    lower = 0.5 + offset * h
    heat_law = {"fourier": {"kappa": 1.0, "alpha": 1.0} | material}
    return core.experiment(
        grid={"dimension": 1, "size": [3.5], "cell": h},
        bodies={"body": {"shape": {"box": {"lower": [lower], "upper": [lower + 2]}}, "temperature": core.HOT, "material": "solid", "velocity": [speed]}},
        materials={"solid": core.config()["materials"]["solid"] | {"density": 1.0, "heat": heat_law}},
        surfaces=[{"of": "body"} | (surface or {"convection": {"beta": biot, "outside": core.COLD}})],
        time={"end": END},
        output={"every": END},
        method={"heat": heat, "heat_step": step},
        exact={"robin_slab": {}},
    )


def cooled(core, experiment, speed=1.0):
    """(root-mean-square error in units of the fall, run)."""
    scene, run = core.play(experiment)
    assert run.outcome.ok
    assert abs(run.finals["heat_ledger"]) <= 1e-12 * max(abs(run.finals["heat_exchanged"]), 1e-6)
    body = scene.bodies[0]
    x = body.particles.x - speed * END
    wrong = (core.HOT + body.thermal.theta - exact_solution(experiment)(x, END)) / (core.HOT - core.COLD)
    return np.sqrt(np.average(wrong**2, weights=body.particles.V0)), run


@pytest.mark.parametrize("biot", [1.0, 10.0, INF])
def test_slab_at_the_worst_of_offsets(core, biot):
    worst = [max(cooled(core, slab(core, biot, n, offset))[0] for offset in (0, 0.15, 0.3, 0.45)) for n in (8, 16, 32)]
    assert core.order(worst) > 1.7 and worst[-1] < 5e-4


def test_second_order_in_time(core):
    """Steps of 0.02 (Fourier number of the cell 20): the first order is 1e-2 off, the second 1e-3."""
    first, second = (cooled(core, slab(core, 10.0, 32, heat=heat, step=0.02))[0] for heat in (IMPLICIT, SECOND))
    assert second < 2e-3 < 4e-3 < first


def test_infinite_beta_is_a_fixed_temperature(core):
    runs = [cooled(core, slab(core, INF, 8))[1], cooled(core, slab(core, INF, 8, surface={"fixed": {"temperature": core.COLD}}), 1.0)[1]]
    assert runs[0].finals["temperature_mean"] == runs[1].finals["temperature_mean"]


def test_any_beta_ends_and_cools_more_than_a_smaller_one(core):
    """Strictly below the penalty of 1000 kappa/h, above which all are a fixed temperature."""
    betas = [0.0, 1e-3, 1e-1, 1.0, 1e1, 1e2, 1e4, 1e6, 1e9, 1e12, INF]
    runs = [core.play(slab(core, beta, 8, heat="auto"))[1] for beta in betas]
    assert all(run.outcome.ok for run in runs)
    mean, low = ([run.finals[name] for run in runs] for name in ("temperature_mean", "temperature_min"))
    assert np.all(np.diff(mean[:7]) < 0) and np.all(np.diff(mean) <= 1e-9) and min(low) > core.COLD
    assert "heat_steps_implicit" not in runs[3].facts and runs[-1].facts["heat_steps_implicit"] > 0


def test_tolerance_does_not_enter_the_ledger(core):
    loose, tight = (cooled(core, slab(core, 10.0, 8, heat={"implicit": {"tolerance": t}}))[1] for t in (1e-2, 1e-12))
    assert loose.facts["heat_iterations"] <= tight.facts["heat_iterations"] == tight.facts["heat_steps_implicit"]  # in one direction the factor is whole
    assert loose.finals["temperature_mean"] == pytest.approx(tight.finals["temperature_mean"], abs=0.5)


BUMP = {"bump": {"base": 1.0, "heat": 100.0, "at": 350.0, "width": 2.0}}
EVERY_WAY = [("auto", "auto"), ("auto", 0.02), ("explicit", 0.02), ("stabilised", 0.02), ("implicit", "auto"), ("implicit", 0.02), ("implicit", 0.5)]


def through_a_bump(core, n, end, heat, step, **rest):
    """The slab at rest, cooled through 100 J/kg of latent heat, 50 times what a kelvin takes over its width."""
    data = slab(core, 50.0, n, heat=heat if isinstance(heat, dict) else {heat: {}}, step=step, alpha=BUMP).resolved()
    data |= {"exact": None, "time": {"end": end}, "output": {"every": end / 10, "observables": ["temperature.mean"]}}
    data["bodies"]["body"]["velocity"] = [0.0]
    return mpm.run_point(mpm.load(data, rest))


@pytest.mark.parametrize(("heat", "step"), [pytest.param(*way, marks=[] if way == ("implicit", 0.02) else pytest.mark.wide) for way in EVERY_WAY])
def test_latent_heat_is_not_jumped_over(core, heat, step):
    """What is not sensible heat is latent, whatever step and way, within 5 % of the bounds (with capacities of the step's start: 41 to 359 K beyond)."""
    run = through_a_bump(core, 8, 4.0, heat, step)
    assert run.outcome.ok and run.facts["warnings"] == []
    assert run.series["temperature_min"].min() > core.COLD - 5 and run.series["temperature_max"].max() < core.HOT + 5
    assert run.finals["temperature_max"] < 340, "the front should have passed"
    assert run.finals["heat_exchanged"] == pytest.approx(2 * (run.finals["temperature_mean"] - core.HOT - 100.0), rel=1e-6)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * abs(run.finals["heat_exchanged"])


def test_melting_by_particles_is_that_of_the_rigid_body(core):
    """Against immersed Galerkin with 128 cells (mpm.rigid) in steps of 0.02, 20 h^2/diffusivity at n = 32: 0.42, 0.097, 0.019 K of 100."""
    held = slab(core, 50.0, 128, alpha=BUMP).resolved() | {"exact": None, "time": {"end": 2.0}, "output": {"every": 0.2, "observables": ["temperature.mean"]}}
    held["method"] = {"rigid": {"implicit": {"tolerance": 1e-5}}}
    del held["bodies"]["body"]["velocity"]
    held["materials"]["solid"] = {name: held["materials"]["solid"][name] for name in ("density", "heat")}
    mean = mpm.run_point(mpm.load(held)).series["temperature_mean"]
    apart = [np.sqrt(np.mean((through_a_bump(core, n, 2.0, SECOND, 0.02).series["temperature_mean"] - mean) ** 2)) for n in (8, 16, 32)]
    assert core.order(apart) > 1.8 and apart[-1] < 0.03


FLAT = {
    "bump": {"base": 1.0, "heat": 0.0, "at": 350.0, "width": 2.0},
    "table": {"temperature": [200.0, 500.0], "value": [1.0, 1.0]},
    "logistic": {"low": 1.0, "high": 1.0, "at": 350.0, "width": 2.0},
}


@pytest.mark.parametrize("law", [pytest.param(law, marks=pytest.mark.wide if law == "bump" else pytest.mark.slow) for law in FLAT])
def test_a_constant_law_by_way_of_enthalpy_is_the_constant(core, law):
    """A bump of no heat, a table of one value: the nonlinear step has nothing to do, and gives what the linear one gives."""
    for heat in (IMPLICIT, SECOND, EXPLICIT, {"stabilised": {}}):
        data = [slab(core, 10.0, 8, heat=heat, step=0.01, alpha=alpha).resolved() | {"exact": None} for alpha in (1.0, {law: FLAT[law]})]
        one, other = (core.play(mpm.load(one))[0].bodies[0].thermal.theta for one in data)
        assert np.allclose(one, other, rtol=0, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
def test_other_dimensions(core, dimension):
    """A hot box cools between its own and the air's temperature, and keeps its ledger."""
    experiment = core.experiment(
        dimension, surfaces=[{"of": "body", "fixed": {"temperature": core.COLD}}], method={"heat": IMPLICIT}, time={"end": 0.2}, output={"every": 0.2}
    )
    _, run = core.play(experiment)
    assert run.outcome.ok and core.COLD < run.finals["temperature_min"] < run.finals["temperature_max"] < core.HOT
    assert run.facts["heat_iterations"] < 25 * run.facts["heat_steps_implicit"]
    _, loose = core.play(mpm.load(experiment.resolved() | {"method": {"heat": {"implicit": {"tolerance": 1e-2}}}}))
    assert loose.facts["heat_iterations"] < 0.8 * run.facts["heat_iterations"]
    assert abs(loose.finals["heat_ledger"]) < 1e-12 * abs(loose.finals["heat_exchanged"])
    assert abs(run.finals["heat_ledger"]) < 1e-12 * abs(run.finals["heat_exchanged"])
