"""Time scaling: the same slow scene sooner, and the measure of the inertia that it lets in."""

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.scene.scaling import hurried

pytestmark = pytest.mark.plain


def creep(core, scale, **time):
    """A viscous column in one direction that sags under gravity while air warms it: relaxation 2 s, 20 s in all."""
    solid = {"density": 1.0, "elastic": {"hencky": {"lam": 200.0, "mu": 200.0}}, "flow": {"ellipse": {"M": 0.1, "p0": 0.5, "eta": 400.0}},
             "heat": {"fourier": {"kappa": {"logistic": {"low": 0.02, "high": 0.04, "at": 350, "width": 10}}, "alpha": 1.5}}}  # fmt: skip
    air = {"table": {"time": [0, 10, 10.1], "value": [400, 400, 300]}}
    data = core.config(1, bodies={"body": {"shape": {"box": {"lower": [0], "upper": [1.5]}}, "temperature": 300.0, "material": "solid"}},
                       surfaces=[{"of": "body", "side": "right", "convection": {"beta": 0.1, "outside": air}}])  # fmt: skip
    data["materials"]["solid"] = solid
    data |= {"gravity": [-1.0], "time": {"end": 20.0, "scale": scale} | time}
    data["output"] = {"every": 1.0, "probes": {"top": [1.4]}, "observables": ["time_to.top.302_K"]}
    return mpm.load(data)


def test_the_same_states_sooner(core):
    slow, fast = (mpm.run_point(creep(core, S)) for S in (1.0, 8.0))
    assert slow.outcome.ok and fast.outcome.ok and fast.steps < slow.steps / 7
    assert np.allclose(fast.times, slow.times, rtol=1e-12)
    late = slow.times > 4
    for name in ("temperature_top", "position_mean_x", "dissipation_total", "heat_exchanged"):
        assert np.abs(fast.series[name] - slow.series[name])[late].max() < 0.05 * np.ptp(slow.series[name]), name
    assert fast.finals["time_to_top_302_K"] == pytest.approx(slow.finals["time_to_top_302_K"], rel=0.01)
    assert "time_scaling" not in slow.facts and "scaling_froude" not in slow.finals
    assert fast.facts["time_scaling"]["valid"] and fast.facts["warnings"] == slow.facts["warnings"] == []


def test_too_much_is_said(core):
    run = mpm.run_point(creep(core, 200.0))
    assert run.outcome.ok and not run.facts["time_scaling"]["valid"]
    assert [text for text in run.facts["warnings"] if text.startswith("inertia: time scaling by 200 lets inertia in: ") and "kinetic share" in text]
    assert run.finals["scaling_kinetic"] > 0.05


def test_what_is_scaled(core):
    before = creep(core, 10.0, step=1e-3)
    after = hurried(before)
    assert (after.time.end, after.time.step, after.output.every) == (2.0, 1e-4, 0.1)
    heat, flow = after.materials["solid"].heat, after.materials["solid"].flow
    assert (heat.kappa.low, heat.kappa.high, heat.alpha.value, flow.eta.value, flow.M.value) == pytest.approx((0.2, 0.4, 1.5, 40.0, 0.1))
    air = after.surfaces[0].convection
    assert air.beta == 1.0 and air.outside.time == pytest.approx((0, 1, 1.01)) and air.outside.value == (400, 400, 300)
    assert hurried(creep(core, 1.0)) == creep(core, 1.0)


def test_books_close_on_what_is_shown(core):
    """What the total loses, gravity's part with it, flow dissipates or transfers lose: also while motion holds what the fast clock lends it."""
    run = mpm.run_point(creep(core, 100.0))
    gone = run.series["energy_total"][0] - run.series["energy_total"]
    off = gone + run.series["work_loads"] - run.series["dissipation_total"] - run.series["dissipation_transfer"]
    assert run.outcome.ok and np.abs(off).max() < 1e-12 * np.abs(gone).max()
    assert run.series["energy_ledger"] == pytest.approx(run.series["heat_ledger"] - run.series["dissipation_transfer"], abs=1e-12 * np.abs(gone).max())


def test_velocities_leave_the_run_physical(core):
    data = core.config(1, time={"end": 0.5, "scale": 5.0})
    data["bodies"]["body"]["velocity"] = [0.02]
    run = mpm.run_point(mpm.load(data | {"surfaces": []}))
    assert run.series["velocity_max"] == pytest.approx(0.02, rel=1e-9)
    assert np.diff(run.series["position_mean_x"]) == pytest.approx(0.002, rel=1e-6)
    assert run.series["energy_kinetic"] == pytest.approx(0.5 * run.finals["mass_total"] * 0.02**2, rel=1e-9)


def test_only_where_there_is_inertia(core):
    data = core.config(1, time={"end": 1.0, "scale": 5.0})
    data["materials"]["solid"] = {"density": 1.0, "heat": data["materials"]["solid"]["heat"]}
    with pytest.raises(ConfigError, match="nothing here has inertia"):
        mpm.load(data)


def test_energies_of_motion_leave_the_run_by_the_square_of_the_scale(core):
    """Velocities are S times too large on the fast clock, so kinetic energy is S^2 times: in the total as in its part."""
    from mpm.outcome import COMPLETED, Run, outcome
    from mpm.scene.scaling import physical

    series = {"energy_kinetic": np.array([50.0, 75.0]), "energy_elastic": np.array([1.0, 2.0]), "dissipation_total": np.zeros(2)}
    series |= {"energy_total": series["energy_kinetic"] + series["energy_elastic"], "velocity_max": np.array([5.0, 5.0])}
    series |= {"dissipation_transfer": np.array([0.0, -26.0]), "energy_ledger": np.array([0.0, 26.0])}  # nothing works on it
    run = Run(outcome(COMPLETED), np.array([0.0, 1.0]), series, {}, steps=1, wall_time=0.0, facts={"warnings": []})
    after = physical(run, mpm.load(core.config(1, time={"end": 5.0, "scale": 5.0}, surfaces=[])))
    assert after.series["energy_kinetic"] == pytest.approx([2.0, 3.0]) and after.series["energy_total"] == pytest.approx([3.0, 5.0])
    assert after.series["velocity_max"] == pytest.approx([1.0, 1.0]) and after.times == pytest.approx([0.0, 5.0])
    assert after.series["dissipation_transfer"] == pytest.approx([0.0, -2.0]) and after.series["energy_ledger"] == pytest.approx([0.0, 2.0])
