"""Snapshots are at the times asked for, 0, every, 2 every, ..., end, whatever the cadence of the series, and their bytes are those that are counted."""

from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.observe import merged, near
from mpm.runner import run_point
from mpm.scene.inventory import output_bytes

SLAB = Path(__file__).parents[1] / "configs" / "verification" / "robin_slab.yaml"
ASKED = {0.07: [0, 0.07, 0.14, 0.21, 0.28, 0.35, 0.42, 0.49, 0.5], 0.3: [0, 0.3, 0.5], 0.1: [0, 0.1, 0.2, 0.3, 0.4, 0.5], 2.0: [0, 0.5]}


def test_merging_times():
    times, others = np.array([0, 0.1, 0.2, 0.1 + 0.2]), np.array([0, 0.15, 0.3, 0.4])
    assert merged(times, others).tolist() == [0, 0.1, 0.15, 0.2, 0.1 + 0.2, 0.4] and merged(times, np.zeros(0)) is times
    assert near(merged(times, others), times).tolist() == [True, True, False, True, True, False]
    assert near(np.zeros(0), times).tolist() == [] and near(times, np.zeros(0)).tolist() == [False] * 4


@pytest.mark.parametrize("every", ASKED)
def test_of_a_body_that_flies(core, every):
    """At a constant speed, so that where it is tells when it was seen."""
    output = {"every": 0.1, "snapshots": {"every": every, "grid": ["velocity"], "particles": ["position", "mass"]}}
    run = run_point(core.experiment(1, {"bodies.body.velocity": [0.2]}, output=output))
    np.testing.assert_allclose(run.snapshot_times, ASKED[every], rtol=1e-12)
    np.testing.assert_allclose(run.times, np.arange(6) * 0.1, rtol=1e-12)
    middle = np.array([rows["position"][:, 0] @ rows["mass"] / rows["mass"].sum() for rows in run.particles])
    np.testing.assert_allclose(middle - middle[0], 0.2 * run.snapshot_times, rtol=1e-9, atol=1e-12)
    assert len(run.grid["velocity_x"]) == len(run.particles) == len(ASKED[every])


@pytest.mark.parametrize("compared", [True, False])
def test_of_a_body_that_stands(compared):
    def run(every, shots=None):
        output = {"output.every": every} | ({"output.snapshots": {"every": shots, "grid": ["temperature"]}} if shots else {})
        return run_point(mpm.load(SLAB, {"time.end": 0.1, **output} | ({} if compared else {"exact": None})))

    fine, apart, plain = run(0.007, 0.007), run(0.02, 0.007), run(0.02)
    asked = [*np.arange(15) * 0.007, 0.1]
    np.testing.assert_allclose(apart.snapshot_times, asked, rtol=1e-12)
    np.testing.assert_allclose(fine.snapshot_times, asked, rtol=1e-12)
    np.testing.assert_array_equal(apart.grid["temperature"], fine.grid["temperature"])
    shown = apart.grid["temperature"]
    assert len(np.unique(shown[:, np.isfinite(shown[0])], axis=0)) == 16
    assert apart.series.keys() == plain.series.keys() and ("error_l2" in plain.series) == compared
    for name, values in plain.series.items():
        np.testing.assert_array_equal(apart.series[name], values)


def test_bytes_are_of_frames_that_exist(core):
    def counted(every):
        experiment = core.experiment(1, output={"every": 0.1, "snapshots": {"every": every, "particles": ["position"]}})
        return output_bytes(experiment, 1000) - output_bytes(core.experiment(1, output={"every": 0.1}), 1000)

    assert [counted(every) / 24_000 for every in ASKED] == [len(times) for times in ASKED.values()]
