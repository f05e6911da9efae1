"""`method.frame: auto`: which frame and why, and a run that is outgrown goes over to the updated frame."""

import functools

import numpy as np
import pytest

import mpm
from mpm.config.rules_frame import named
from mpm.costs import settled
from mpm.diagnostics import exchanging_area
from mpm.runner import estimate, run_point
from mpm.scene.build import build
from mpm.scene.framing import choice
from mpm.scene.over import go_over
from mpm.simulation import simulate
from mpm.total.drive import show_all
from mpm.total.inertia import impel
from mpm.total.step import force_all
from mpm.transfer import new_chunk

pytestmark = pytest.mark.plain


def bar(**changes):
    """A bar between two walls, on neither."""
    return mpm.load({
        "grid": {"dimension": 1, "size": [2.0], "cell": 0.125}, "bodies": {"bar": {"shape": {"box": {"lower": [0.5], "upper": [1.5]}}, "material": "m"}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}}}, "time": {"end": 1.0}, "method": {"frame": "auto"},
        "output": {"every": 0.1},
    }, changes)  # fmt: skip


FLOW = {"ellipse": {"M": 1e-3, "p0": 1.0, "eta": 1.0}}
OTHER = {"shape": {"box": {"lower": [1.6], "upper": [1.8]}}, "material": "m"}


@pytest.mark.parametrize(("changes", "frame", "why"), [
    ({}, "total", "nothing in the config"),
    ({"materials.m.flow": FLOW}, "total", "nothing in the config"),  # nothing loads it
    ({"materials.m.flow": FLOW, "gravity": [-1.0]}, "updated", "bar may flow"),
    ({"walls.left": "contact"}, "updated", "no contact"),
    ({"bodies.other": OTHER}, "updated", "one body only"),
    ({"method.transfer": "flip"}, "updated", "transfers nothing"),
    ({"method.mechanics": "implicit"}, "total", "nothing in the config"),
    ({"grid.basis": "linear"}, "updated", "hat functions"),
])  # fmt: skip
def test_which_frame_and_why(changes, frame, why):
    """The reason is what `method.frame: total` would refuse."""
    experiment = bar(**changes)
    found = choice(experiment)
    assert found[0] == frame and why in found[1]
    if experiment.method.mechanics == "explicit":
        assert estimate(experiment)["frame"] == f"{frame}: {found[1]}"


def test_it_is_the_total_frame_while_that_will_do():
    run, total = run_point(bar(**{"bodies.bar.velocity": [0.01]})), run_point(bar(**{"bodies.bar.velocity": [0.01], "method.frame": "total"}))
    assert run.outcome.ok and run.facts["frame"]["name"] == "total"
    np.testing.assert_array_equal(run.series["position_mean_x"], total.series["position_mean_x"])
    assert "frame" not in total.facts


def test_what_comes_to_a_wall_goes_over_and_bounces():
    """Thrown at a wall that it did not lie on: by the total frame alone it would fly through. Momentum is kept as it goes over, up to the wall."""
    thrown = {"bodies.bar.velocity": [0.9]}
    run, updated, total = (run_point(bar(**thrown, **{"method.frame": frame})) for frame in ("auto", "updated", "total"))
    assert run.outcome.ok and run.facts["frame"]["name"] == "updated" and "on which it did not lie" in run.facts["frame"]["why"]
    assert "total until t = 0.5 s" in run.facts["frame"]["why"]  # its end is 0.05 m from the wall
    assert run.series.keys() == updated.series.keys() and {len(values) for values in run.series.values()} == {11}
    assert run.series["momentum_x"][:6] == pytest.approx(0.9, rel=1e-12) and run.series["momentum_x"][-1] < 0.5
    assert run.series["position_mean_x"] == pytest.approx(updated.series["position_mean_x"], abs=5e-3)
    assert run.series["energy_ledger"] == pytest.approx(-run.series["dissipation_transfer"], abs=1e-15)
    assert total.outcome.kind == "outgrown" and "method.frame: updated" in total.outcome.advice and total.times[-1] < 0.7


def test_what_has_passed_a_wall_already_begins_again():
    """The next output time is beyond the wall: the run is that of the updated frame to the bit."""
    thrown = {"bodies.bar.velocity": [0.9], "output.every": 1.0}
    run, updated = (run_point(bar(**thrown, **{"method.frame": frame})) for frame in ("auto", "updated"))
    assert run.outcome.ok and run.facts["frame"]["name"] == "updated" and "total frame was left" in run.facts["frame"]["why"]
    for name in run.series:
        np.testing.assert_array_equal(run.series[name], updated.series[name])


def test_going_over_carries_the_state():
    """A warm disc, squeezed, turned and moving, under a pressure and in a draught: its state is kept, its area and the pressure's power are those of a disc."""
    data = {
        "grid": {"dimension": 2, "size": [2.0, 2.0], "cell": 0.125},
        "bodies": {"disc": {"shape": {"ball": {"centre": [1.01, 0.97], "radius": 0.6}}, "material": "m"}},
        "materials": {"m": {"density": 2, "elastic": {"hencky": {"E": 1, "nu": 0.3}}, "heat": {"fourier": {"kappa": 0.1, "alpha": 1.5}}}},
        "surfaces": [{"of": "disc", "side": "all", "convection": {"beta": 1, "outside": 350}}], "method": {"frame": "total", "particles": 3},
        "loads": [{"of": "disc", "side": "all", "traction": {"pressure": 0.2}}], "time": {"end": 1.0}, "output": {"every": 1.0},
    }  # fmt: skip
    experiment = mpm.load(data)
    before = build(experiment)
    (body,), (reference,), F = before.bodies, before.references, np.array([[0.9, -0.3], [0.25, 0.8]])
    place = np.stack(np.unravel_index(np.arange(len(reference.u)), before.space[1:3]), axis=-1) * 0.125 - 2 * 0.125
    reference.u[:, :2] = (place - 1.0) @ (F - np.eye(2)).T
    reference.v[:, :2] = 0.1 * np.sin(3 * place) + 0.2
    body.thermal.theta[:] = 300 + np.random.default_rng(4).normal(size=len(reference.X))
    report = np.zeros(32)
    force_all(before.space, body, reference, new_chunk(2, reference.f, True, False), 0.0, report)
    show_all(before)
    after = go_over(named(experiment, "updated"), None, before, 0.3)
    new = after.bodies[0]
    for name in body.particles._fields:
        np.testing.assert_array_equal(getattr(new.particles, name), getattr(body.particles, name))
    nodes = np.sum(reference.m[reference.active, None] * reference.v[reference.active, :2], axis=0)
    assert np.sum(new.particles.m[:, None] * new.particles.v, axis=0) == pytest.approx(nodes, rel=1e-12)
    assert new.particles.x == pytest.approx(reference.X @ F.T - F.sum(axis=1) + 1.0, rel=1e-12)
    np.testing.assert_array_equal(new.thermal.theta, body.thermal.theta)
    G = np.linalg.det(F) * np.linalg.inv(F).T
    around = 2 * np.pi * (np.arange(2000) + 0.5) / 2000
    normal = np.stack([np.cos(around), np.sin(around)], axis=1)
    assert exchanging_area(new) == pytest.approx(2 * np.pi * 0.6 * np.mean(np.linalg.norm(normal @ G.T, axis=1)), rel=2e-3)
    load = new.source
    assert np.all(load.t == 0.3) and load.F == pytest.approx(np.tile(F, (len(load.F), 1, 1)), abs=1e-12)
    L = np.array([[0.3, -0.2], [0.5, 0.1]])
    power = np.sum(load.force * (new.particles.x @ L.T)) + np.einsum("pck,pdk,cd->", load.dipole, load.F, L)
    assert power == pytest.approx(-0.2 * np.trace(L) * np.linalg.det(F) * np.pi * 0.36, rel=1e-6)


def test_a_strain_past_ln_2_is_outgrown():
    """Weak moduli and a velocity that stretches: homogeneous in 1-D, J grows as 1 + t. It ends there, or goes over and on as before."""
    experiment = bar(
        **{
            "materials.m.elastic.hencky.E": 1e-12,
            "grid.size": [4.0],
            "bodies.bar.shape": {"box": {"lower": [1.5], "upper": [2.5]}},
            "time.end": 1.5,
            "time.step": 0.05,
        }
    )

    def stretched(over=None):
        scene = build(settled(experiment))
        scene.moderate, scene.over = np.log(2.0), over
        reference, h = scene.references[0], scene.space.h
        reference.v[:, 0] = (np.arange(len(reference.v)) - 2) * h - 2.0
        impel(reference)
        return simulate(scene)

    run = stretched()
    assert run.outcome.kind == "outgrown" and "strained by" in run.outcome.message
    assert run.times[-1] == pytest.approx(0.9)  # J = 1.9; the next, 2.2, is past it
    run = stretched(functools.partial(go_over, named(experiment, "updated"), None))
    assert run.outcome.ok and "total until t = 1 s: it is strained by" in run.facts["over"]
    assert run.series["volume_total"][:11] == pytest.approx(1 + run.times[:11], rel=1e-9)
    assert run.series["volume_total"] == pytest.approx(1 + run.times, rel=2e-3)  # the slopes of APIC are those of the step before: off by dt/2J in it
    assert run.series["position_max_x"] == pytest.approx(2.5 + 0.5 * run.times, rel=1e-3)
    assert run.series["mass_total"] == pytest.approx(1.0, rel=1e-12) and run.series["momentum_x"] == pytest.approx(0.0, abs=1e-12)


def test_a_sweep_says_which_frame_answered_each_point(tmp_path):
    experiment = mpm.load(
        bar(**{"bodies.bar.velocity": [0.0]}).template() | {"sweep": {"points": [{"bodies.bar.velocity": [0.01]}, {"bodies.bar.velocity": [0.9]}]}}
    )
    tree = mpm.sweep(experiment, out=tmp_path / "out", jobs=0)
    assert tree.frame_name.values.tolist() == ["total", "updated"]
    assert "on which it did not lie" in str(tree.frame_why.values[1])
