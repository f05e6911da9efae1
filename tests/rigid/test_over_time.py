"""What acts on bodies that do not move for a part of the run, or jumps: a slab that is flipped, against the exact solution of its two phases."""

import math
from itertools import pairwise

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.heat.programmes import Parts, at, bounds, during, longest, spell, turns
from mpm.materials import table
from mpm.rigid import Joint, Method, RigidBody, solve
from mpm.rigid.linear import LinearSteps
from mpm.scene import Box
from mpm.scene.refusal import SceneError
from mpm.verification.layers import Layer, Layers

FLIP, END, HOT, COOL = 0.1, 0.3, (10.0, 400.0), (1.0, 310.0)  # beta, outside


class Phase:
    """A slab from 0 to 1 between two exchanges, from any start: the steady line, and modes of the homogeneous problem."""

    def __init__(self, left, right, start):
        self.modes = Layers([Layer(0.0, 1.0, 1.0, 1.0, 1.0, right[0])], left[0], 0.0, False)
        slope = (right[1] - left[1]) / (1 + 1 / left[0] + 1 / right[0])
        self.steady = lambda x: left[1] + slope * (1 / left[0] + x)
        x, w = self.modes.weights[0]
        phi = self.modes.modes(self.modes.roots, 0, x)
        self.part = (phi @ (w * (start(x) - self.steady(x)))) / (phi**2 @ w)

    def __call__(self, x, t):
        z = self.modes.roots
        return self.steady(x) + (self.part * np.exp(-(z**2) * t)) @ self.modes.modes(z, 0, x)


@pytest.fixture(scope="module")
def exact():
    first = Phase(HOT, COOL, lambda x: np.full(len(x), 300.0))
    second = Phase(COOL, HOT, lambda x: first(x, FLIP))
    return lambda x, t: first(x, t) if t <= FLIP else second(x, t - FLIP)


def jump(one, two):
    return Parts((FLIP,), (float(one), float(two)))


def slab(low=0.0, high=1.0):
    surfaces = (("left", jump(HOT[0], COOL[0]), jump(HOT[1], COOL[1])),) if low == 0 else ()
    if high == 1:
        surfaces += ("right", spell(COOL[0], 0.0, FLIP), COOL[1]), ("right", spell(HOT[0], FLIP), HOT[1])
    return RigidBody(Box((low,), (high,)), 300.0, 1.0, 1.0, 1.0, surfaces)


WAYS = {"implicit": (Method(tolerance=1e-6), 1e-4, 1),
        "order 2": (Method("implicit", order=2, tolerance=1e-6), 1e-4, 1), "two halves": (Method(tolerance=1e-6), 1e-4, 2),
        "explicit": (Method("explicit", tolerance=1e-5), 1e-3, 1), "bounded": (Method("bounded", tolerance=1e-4), 2e-3, 1)}  # fmt: skip


@pytest.mark.parametrize("name", WAYS)
def test_flip(name, exact, monkeypatch):
    """Within 1e-4 of the 100 K by splines and consistent mass, of order 2 by the others; a step ends on the jump; the ledger closes."""
    method, most, pieces = WAYS[name]
    ends, accept = [], LinearSteps.accept
    monkeypatch.setattr(LinearSteps, "accept", lambda self: (accept(self), ends.append(self.now)))
    bodies = [slab()] if pieces == 1 else [slab(0.0, 0.4), slab(0.4, 1.0)]
    run = solve(bodies, 1, 1 / 32, [0.3 / 32], END, [0.0, 0.05, FLIP, 0.15, 0.2, END], {"l": [0.0], "r": [1.0], "m": [0.5]}, method=method,
                joints=[Joint(0, 1)] * (pieces - 1))  # fmt: skip
    for probe, x in (("l", 0.0), ("m", 0.5), ("r", 1.0)):
        found = [exact(np.array([x]), t)[0] for t in run.times[1:]]
        np.testing.assert_allclose(run.series[f"temperature.{probe}"][1:], found, atol=100 * most)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
    if method.kind in ("auto", "implicit"):
        assert min(abs(end - FLIP) for end in ends) < 1e-15


def test_a_contact_that_ends_uncovers():
    """A hot plate on a slab until 0.1; from then on the air of the slab's entry is on its whole surface, as on a slab that was alone from there on."""
    bodies = [RigidBody(Box((0.0,), (0.5,)), 400.0, 1.0, 1.0, 1.0), RigidBody(Box((0.5,), (1.0,)), 300.0, 1.0, 1.0, 1.0, (("left", 5.0, 350.0),))]
    run = solve(bodies, 1, 1 / 32, end=0.3, times=[0.0, 0.1, 0.2, 0.3], joints=[Joint(0, 1, end=0.1)], method=Method(tolerance=1e-6))
    assert run.passed[0, 1][1] > 0
    np.testing.assert_allclose(run.passed[0, 1][2:], run.passed[0, 1][1], rtol=1e-13)
    np.testing.assert_allclose(run.of[1]["heat_exchanged"][1], 0.0, atol=1e-12)
    assert abs(run.of[1]["heat_exchanged"][3]) > 0.1
    np.testing.assert_allclose(run.of[0]["heat"][1:], run.of[0]["heat"][1], rtol=1e-13)  # the plate is left alone, insulated
    for one in run.of:
        assert np.abs(one["heat_ledger"]).max() < 1e-12 * run.passed[0, 1][1]


def test_flux_by_a_programme():
    """What has come in is the integral of the flux."""
    rise = Parts((0.1,), (table((0.0, 0.1), (0.0, 50.0), "linear"), 20.0))
    body = RigidBody(Box((0.0,), (1.0,)), 300.0, 1.0, 1.0, 1.0, fluxes=(("left", rise),))
    run = solve([body], 1, 1 / 16, end=0.2, times=[0.0, 0.1, 0.2], method=Method(tolerance=1e-6))
    np.testing.assert_allclose(run.series["heat_exchanged"], [0.0, 2.5, 4.5], rtol=1e-9)


def test_programmes():
    steps = Parts((1.0, 2.0), (5.0, table((1.0, 2.0), (10.0, 20.0), "linear"), 7.0))
    assert [at(steps, t) for t in (0.0, 1.0, 1.5, 2.0, 9.0)] == [5.0, 10.0, 15.0, 7.0, 7.0]
    assert at(during(steps, 1.0), 2.0) == 20.0
    assert turns(steps) == (1.0, 2.0) and bounds(steps) == (5.0, 20.0) and longest(steps) == 0.25
    within = spell(steps, 0.5, 1.5)
    assert [at(within, t) for t in (0.0, 0.5, 1.2, 1.5, 3.0)] == [0.0, 5.0, 12.0, 0.0, 0.0]
    assert spell(3.0) == 3.0 and math.isinf(at(spell(math.inf, 1.0), 2.0))


def config(surface, more=None):
    return {
        "grid": {"dimension": 1, "size": [1.25], "cell": 0.0625}, "time": {"end": 0.3}, "output": {"every": 0.1},
        "materials": {"m": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
        "bodies": {"slab": {"shape": {"box": {"lower": [0.1], "upper": [1.1]}}, "temperature": 300, "material": "m"}}, "surfaces": [surface], **(more or {}),
    }  # fmt: skip


def test_from_a_config():
    """A table that jumps is `from` and `until`; a beta that changes gradually is refused with its place."""
    beta = {"table": {"time": [0, 0.1, 0.1, 0.3], "value": [10, 10, 0, 0]}}
    one = mpm.run_point(mpm.load(config({"of": "slab", "side": "left", "convection": {"beta": beta, "outside": 400}})))
    two = mpm.run_point(mpm.load(config({"of": "slab", "side": "left", "until": 0.1, "convection": {"beta": 10, "outside": 400}})))
    assert one.finals["heat_total"] == two.finals["heat_total"] == pytest.approx(one.series["heat_total"][1], rel=1e-12)
    beta["table"]["time"] = [0, 0.1, 0.2, 0.3]
    with pytest.raises(SceneError, match=r"surfaces.*beta changes gradually"):
        mpm.run_point(mpm.load(config({"of": "slab", "side": "left", "convection": {"beta": beta, "outside": 400}})))
    for wrong, said in (({"from": 0.2, "until": 0.1}, "end before it begins"), ({"from": -1}, "begins at 0")):
        with pytest.raises(ConfigError, match=said):
            mpm.load(config({"of": "slab", "convection": {"beta": 1, "outside": 400}, **wrong}))


@pytest.mark.parametrize("heat", ["explicit", pytest.param("implicit", marks=pytest.mark.wide)])
def test_flip_of_a_body_that_could_move(exact, heat):
    """The same by particles: heat steps end on the jump; 0.2 % of the range at 32 cells."""
    beta = {"table": {"time": [0, FLIP, FLIP, END], "value": [HOT[0], HOT[0], COOL[0], COOL[0]]}}
    outside = {"table": {"time": [0, FLIP, FLIP, END], "value": [HOT[1], HOT[1], COOL[1], COOL[1]]}}
    surfaces = [{"of": "slab", "side": "left", "convection": {"beta": beta, "outside": outside}},
                {"of": "slab", "side": "right", "until": FLIP, "convection": {"beta": COOL[0], "outside": COOL[1]}},
                {"of": "slab", "side": "right", "from": FLIP, "convection": {"beta": HOT[0], "outside": HOT[1]}}]  # fmt: skip
    material = {"density": 1, "elastic": {"hencky": {"E": 0.05, "nu": 0}}, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}
    more = {"surfaces": surfaces, "materials": {"m": material}, "method": {"heat": heat}}
    data = config({}, more) | {"output": {"every": 0.08, "probes": {"m": [0.6], "l": [0.1]}}}
    data["grid"] = {"dimension": 1, "size": [1.25], "cell": 0.03125}
    run = mpm.run_point(mpm.load(data))
    assert run.outcome.ok
    for probe, x in (("m", 0.5), ("l", 0.0)):
        found = [exact(np.array([x]), t)[0] for t in run.times[1:]]
        np.testing.assert_allclose(run.series[f"temperature_{probe}"][1:], found, atol=0.6)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-9 * np.abs(run.series["heat_exchanged"]).max()


def test_a_beta_that_rises(series):
    """A small body that could move, of next to one temperature: 1 - exp(-int beta dt/(rho alpha L))."""
    beta = {"table": {"time": [0, 0.2], "value": [0, 4]}}
    material = {"density": 1, "elastic": {"hencky": {"E": 0.05, "nu": 0}}, "heat": {"fourier": {"kappa": 500, "alpha": 1}}}
    surface = {"of": "slab", "side": "left", "convection": {"beta": beta, "outside": 400}}
    run = mpm.run_point(mpm.load(config(surface, {"materials": {"m": material}, "method": {"heat": "implicit", "heat_step": 0.005}})))
    gained = [0.5 * 20 * min(t, 0.2) ** 2 + 4 * max(t - 0.2, 0.0) for t in run.times]
    np.testing.assert_allclose(run.series["temperature_mean"], 400 - 100 * np.exp(-np.array(gained)), atol=0.5)


def test_a_point_meets_what_is_constant():
    heat = {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}
    data = {"grid": {"dimension": 0}, "time": {"end": 1}, "materials": {"m": heat},
            "bodies": {"b": {"shape": {"point": {"surface_to_volume": 6}}, "material": "m"}}}  # fmt: skip
    for key, more in (("from", {"from": 0.5}), ("beta", {"convection": {"beta": {"sine": {"mean": 3, "amplitude": 1, "period": 1}}, "outside": 400}})):
        with pytest.raises(ConfigError, match=rf"surfaces.0.*{key}"):
            mpm.load(data | {"surfaces": [{"of": "b", "convection": {"beta": 1, "outside": 400}} | more]})


def slabs(cuts, surfaces, contacts=()):
    """Slabs side by side, of one material, at 300 and 340 K."""
    ends = list(pairwise(cuts))
    return mpm.run_point(mpm.load({
        "grid": {"dimension": 1, "size": [0.02], "cell": 5e-4}, "time": {"end": 60.0},
        "materials": {"m": {"density": 1000.0, "heat": {"fourier": {"kappa": 0.5, "alpha": 3000.0}}}},
        "bodies": {f"b{k}": {"shape": {"box": {"lower": [low], "upper": [high]}}, "material": "m", "temperature": 340.0 if k else 300.0}
                   for k, (low, high) in enumerate(ends)},
        "surfaces": surfaces, "contacts": list(contacts), "output": {"every": 10.0, "probes": {"p": [0.003]}},
    })).series["temperature_p"]  # fmt: skip


@pytest.mark.parametrize("late", ["left", "right"])
def test_of_slabs_that_conduct_the_side_held_hardest_may_begin_late(late):
    """Temperatures of a group were relative to another one from then on, and jumped by the difference. A slab, and the same in two of which nothing passes."""
    begin = {"from": 20.0}
    sides = [{"of": "b0", "side": "left", "fixed": {"temperature": 290.0}}, {"of": "b0", "side": "right", "convection": {"beta": 100.0, "outside": 400.0}}]
    sides[late == "right"] |= begin
    whole = slabs([0.002, 0.006], sides)
    apart = [sides[0], *({**sides[1], "of": of} for of in ("b0", "b1"))]
    until = slabs([0.002, 0.006, 0.011], apart, [{"between": ["b0", "b1"], "from": 500.0}])
    np.testing.assert_allclose(until, whole, atol=2e-3)
    assert np.ptp(whole) > 1.0


def test_what_two_slabs_do_when_one_is_held_late_lies_between_their_data():
    sides = [
        {"of": "b0", "side": "left", "fixed": {"temperature": 290.0}, "from": 20.0},
        {"of": "b1", "side": "right", "convection": {"beta": 100.0, "outside": 400.0}},
    ]
    found, steady = slabs([0.002, 0.006, 0.011], sides), slabs([0.002, 0.006, 0.011], [{**side, "from": 0.0} for side in sides])
    assert found[-1] == pytest.approx(steady[-1], abs=0.5) and found.max() < 340.0


def test_a_neighbour_that_leaves_a_slab_uncovers_it_and_no_more():
    """The area that exchanges doubles then; temperatures went by it, and jumped."""
    air = {"convection": {"beta": 180.0, "outside": 400.0}}
    sides = [{"of": "b0", "side": "left", **air}, {"of": "b0", "side": "right", "from": 20.0, **air}]
    found = slabs([0.002, 0.006, 0.011], [{"of": "b0", **air}], [{"between": ["b0", "b1"], "conductance": 0.0, "until": 20.0}])
    np.testing.assert_allclose(found, slabs([0.002, 0.006], sides), atol=2e-3)
