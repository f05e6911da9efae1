"""`method.frame: auto`: which frame and why, and a run that is outgrown begins again in the updated frame."""

import numpy as np
import pytest

import mpm
from mpm.runner import estimate, run_point
from mpm.scene.framing import choice

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


def test_what_is_outgrown_is_the_updated_run_to_the_bit():
    """Thrown at a wall that it did not lie on: by the total frame alone it would fly through, and ends there."""
    thrown = {"bodies.bar.velocity": [0.9]}
    run, updated, total = (run_point(bar(**thrown, **{"method.frame": frame})) for frame in ("auto", "updated", "total"))
    assert run.outcome.ok and run.facts["frame"]["name"] == "updated" and "on which it did not lie" in run.facts["frame"]["why"]
    assert run.series.keys() == updated.series.keys()
    for name in run.series:
        np.testing.assert_array_equal(run.series[name], updated.series[name])
    assert total.outcome.kind == "outgrown" and "method.frame: updated" in total.outcome.advice and total.times[-1] < 0.7


def test_a_strain_past_ln_2_is_outgrown():
    """Weak moduli and a velocity that stretches: homogeneous in 1-D, J grows as 1 + t."""
    experiment = bar(
        **{
            "materials.m.elastic.hencky.E": 1e-12,
            "grid.size": [4.0],
            "bodies.bar.shape": {"box": {"lower": [1.5], "upper": [2.5]}},
            "time.end": 1.5,
            "time.step": 0.05,
        }
    )
    from mpm.costs import settled
    from mpm.scene.build import build
    from mpm.simulation import simulate

    scene = build(settled(experiment))
    scene.moderate = np.log(2.0)
    reference, h = scene.references[0], scene.space.h
    reference.v[:, 0] = (np.arange(len(reference.v)) - 2) * h - 2.0
    run = simulate(scene)
    assert run.outcome.kind == "outgrown" and "strained by" in run.outcome.message
    assert run.times[-1] == pytest.approx(0.9)  # J = 1.9; the next, 2.2, is past it


def test_a_sweep_says_which_frame_answered_each_point(tmp_path):
    experiment = mpm.load(
        bar(**{"bodies.bar.velocity": [0.0]}).template() | {"sweep": {"points": [{"bodies.bar.velocity": [0.01]}, {"bodies.bar.velocity": [0.9]}]}}
    )
    tree = mpm.sweep(experiment, out=tmp_path / "out", jobs=0)
    assert tree.frame_name.values.tolist() == ["total", "updated"]
    assert "on which it did not lie" in str(tree.frame_why.values[1])
