"""Rigid runs are guarded as moving ones are: nothing below absolute zero, far beyond its data or not finite is called ok; kappa = 0 takes fluxes only."""

import numpy as np
import pytest

from mpm.materials.laws import Bump
from mpm.records.checkpoint import pack, unpack
from mpm.rigid import Method, RigidBody, solve
from mpm.rigid.run import NOTICEABLE
from mpm.scene import Ball, Box

INF = float("inf")
TURNED = Box((0.0, 0.0), (1.0, 0.5), 0.4)
BLOCK = Box((0.0, 0.0), (0.04, 0.02))


def freezing(method, keeper=None):
    """A wet block in cold air by steps of 500 s, through a bump of latent heat."""
    body = RigidBody(BLOCK, 293.15, 1000.0, 1.0, Bump(3000.0, 2.5e5, 272.15, 0.5), (("all", 500.0, 243.15),))
    return solve([body], 2, 2e-3, end=5000.0, times=np.arange(0.0, 5001.0, 500.0), method=method, keeper=keeper)


def test_below_absolute_zero_is_no_result():
    """Two faces x 1e5 W/m2 over 2e4 J/m2/K: 10 K/s, so the mean reaches 0 K at 29.3 s; what was recorded before is kept."""
    body = RigidBody(Box((0.005,), (0.015,)), 293.15, 1000.0, 0.5, 2000.0, fluxes=(("all", -1e5),))
    run = solve([body], 1, 1e-3, end=600.0, times=np.arange(0.0, 601.0, 5.0))
    assert run.outcome.kind == "max_principle" and "below absolute zero" in run.outcome.message and "flux" in run.outcome.advice
    assert 0 < run.times[-1] < 29.3 and run.series["temperature.min"].min() > 0 and len(run.series["temperature.mean"]) == len(run.times)


def test_an_automatic_method_keeps_its_data_at_any_step():
    """What was chosen by name falls 9 % of the range below the air, and says so; what was not is changed for `bounded`, with its answer."""
    chosen, free = freezing(Method("implicit", step=500.0)), freezing(Method(step=500.0))
    assert chosen.series["temperature.min"].min() < 243.15 - 0.05 * 50 and max(chosen.facts["beyond"]) > 0.05
    assert free.outcome.ok and free.facts["heat_method"] == ["BoundedSteps"] and free.facts["beyond"] == [0.0]
    assert free.series["temperature.min"].min() >= 243.15 - 1e-9 and free.series["temperature.max"].max() <= 293.15 + 1e-9
    assert np.array_equal(free.series["temperature.mean"], freezing(Method("bounded", tolerance=1e-3, step=500.0)).series["temperature.mean"])


def test_a_second_attempt_goes_on_where_it_was_cut():
    class Keeper:
        found, asked = None, 0

        def due(self, stop):
            self.asked += 1
            return True

        def save(self, memory):
            kept.append(pack(memory, {}))

    kept, again = [], []
    whole = freezing(Method(step=500.0), Keeper())
    for data in kept:
        keeper = Keeper()
        keeper.found, keeper.due = unpack(data)[0], lambda stop: False
        run = freezing(Method(step=500.0), keeper)
        again.append(unpack(data)[0]["again"])
        assert np.array_equal(run.series["temperature.mean"], whole.series["temperature.mean"])
    assert 1 in again


def test_a_shock_of_constant_laws_is_left_to_the_better_method():
    """Steps by their error, constant laws: 1 % beyond the data at a corner for a moment is told, and not worth an order."""
    body = RigidBody(Ball((0.0, 0.0), 1.0), 400.0, 1.0, 1.0, 1.0, (("all", 10.0, 300.0),))
    run = solve([body], 2, 0.25, end=0.2, times=np.linspace(0, 0.2, 11))
    assert run.outcome.ok and run.facts["heat_method"] == ["LinearSteps"] and 0 < max(run.facts["beyond"]) < 0.05


def test_corners_in_a_shock_are_given_to_bounded():
    """26 % beyond the start (tests/rigid/test_bounded.py) is not what an automatic method gives."""
    body = RigidBody(TURNED, 400.0, 1.0, 1.0, 1.0, (("all", INF, 300.0),))
    run = solve([body], 2, 0.1, [0.013, 0.027], 0.1, np.append(0.0, np.geomspace(1e-4, 0.1, 12)))
    assert run.outcome.ok and run.facts["beyond"] == [0.0]


@pytest.mark.parametrize("q", [100.0, -100.0])
def test_a_flux_without_conduction(q):
    """Stays in the cells of the surface, undershoots nowhere, and the mean is exact."""
    body = RigidBody(BLOCK, 293.15, 1000.0, 0.0, 2000.0, fluxes=(("all", q),))
    run = solve([body], 2, 1e-3, end=60.0, times=np.linspace(0, 60, 7))
    rise = q * 0.12 * 60 / (1000.0 * 2000.0 * 8e-4)
    assert run.outcome.ok and run.series["temperature.mean"][-1] - 293.15 == pytest.approx(rise, rel=1e-9)
    still = run.series["temperature.min" if q > 0 else "temperature.max"]
    np.testing.assert_allclose(still, 293.15, atol=1e-9)


@pytest.mark.parametrize("q", [500.0, -50.0])
@pytest.mark.parametrize(("kappa", "told"), [(0.5, False), (1e-2, False), (1e-3, True), (1e-9, True)])
def test_a_flux_bounds_on_its_other_side(q, kappa, told):
    """What only takes in heat becomes no colder than it was: the share is of what was reached, not of what a flux without conduction would lead to."""
    body = RigidBody(Box((0.005,), (0.015,)), 300.0, 1000.0, kappa, 2000.0, fluxes=(("left", q),))
    run = solve([body], 1, 1e-3, end=60.0, times=np.linspace(0, 60, 11))
    least, most = run.series["temperature.min"].min(), run.series["temperature.max"].max()
    over = max(300.0 - least, 0.0) if q > 0 else max(most - 300.0, 0.0)
    assert run.facts["beyond"][0] == pytest.approx(over / (most - least), rel=1e-6, abs=1e-7)
    assert (run.facts["beyond"][0] > NOTICEABLE) == told and run.series["temperature.mean"][-1] == pytest.approx(300.0 + q * 60 / 2e4, rel=1e-9)


def test_a_run_says_what_leaves_its_data():
    """A method that was chosen by name is warned of; the automatic one has nothing to say."""
    import mpm
    from mpm.warned import kinds

    block = {"shape": {"box": {"lower": [0, 0], "upper": ["40 mm", "20 mm"]}}, "temperature": "20 degC", "material": "wet"}
    alpha = {"bump": {"base": 3000, "heat": 2.5e5, "at": "-1 degC", "width": "0.5 K"}}
    data = {
        "grid": {"dimension": 2, "size": ["40 mm", "20 mm"], "cell": "2 mm"}, "bodies": {"block": block},
        "materials": {"wet": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": alpha}}}},
        "surfaces": [{"of": "block", "convection": {"beta": 500, "outside": "-30 degC"}}], "time": {"end": 5000, "step": 500}, "output": {"every": 500},
    }  # fmt: skip
    chosen, free = (mpm.run_point(mpm.load(data, {"method.rigid": kind})) for kind in ("implicit", "auto"))
    assert chosen.outcome.ok and kinds(chosen.facts["warnings"]) == ("temperature",) and kinds(free.facts.get("warnings", ())) == ()
