"""Many points in one call: the same bits as one at a time, whatever shares the call; compiled equals plain Python."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from mpm.materials import ELASTIC, FLOW, LAWS, Constant, Hencky, NoFlow, table
from mpm.point.pick import pick, stack
from mpm.scene.point import batch, run_zero

PULL = [{"until": 0.6, "strain_rate": {"zz": -0.05}, "stress": {"xx": 0, "yy": 0}}, {"stress": {"xx": 0}}]


def same(a, b):
    assert a.outcome == b.outcome and a.steps == b.steps
    assert a.series.keys() == b.series.keys() and np.array_equal(a.times, b.times)
    for name in a.series:
        assert np.array_equal(a.series[name], b.series[name], equal_nan=True), name
    assert {k: v for k, v in a.finals.items() if v == v} == {k: v for k, v in b.finals.items() if v == v}


@pytest.fixture(scope="module")
def mixed(point):
    """Two kinds of flow, three lengths of record, two numbers of stages, one that fails."""
    made = [point(PULL, flow={"eta": eta, "p0": p0}, every=every) for eta in (0.0, 1e4) for p0 in (0.5, 1.0) for every in (0.1, 0.05)]
    made.append(point(PULL[1:], flow={"eta": 1e3}, every=0.2))
    made.append(point([{"until": 0.6, "stretch_rate": {"xx": -3}}, {}], flow={}))
    made.append(point(PULL, flow={"eta": 1e4, "map": "clipped"}))
    return made


def test_batch_equals_single_bitwise(mixed):
    for experiment, run in zip(mixed, batch(mixed), strict=True):
        same(run, run_zero(experiment))
    assert len({run.outcome.kind for run in batch(mixed)}) == 2


def test_points_of_one_kind_are_one_compiled_call(point, monkeypatch):
    """Whatever their values and lengths."""
    import mpm.point.run as room

    made = [point(PULL, flow={"eta": 1e3 + k, "p0": 0.5 + 1e-3 * k}, every=0.1 if k % 2 else 0.05) for k in range(150)]
    calls, whole = [], room.advance
    monkeypatch.setattr(room, "advance", lambda *arguments: calls.append(whole(*arguments)))
    assert all(run.outcome.ok for run in batch(made)) and len(calls) == 1


def test_points_of_a_sweep_are_the_runs_of_one_point(mixed):
    """What the runner adds to a Run is the same, too."""
    from mpm.runner import run_point, run_points

    for one, run in zip(map(run_point, mixed[:2]), run_points(mixed[:2]), strict=True):
        same(one, run)
        assert one.facts == run.facts and "flow: ellipse" in one.facts["physics"]["compiled"]


def test_a_run_cut_at_output_times_has_the_same_bits(mixed):
    told = []
    same(run_zero(mixed[1]), run_zero(mixed[1], beat=lambda fraction, time: bool(told.append((fraction, time)))))
    assert told and all(0 < fraction < 1 and 0 < time < 1 for fraction, time in told)


def test_a_beat_stops_a_run(mixed):
    run = run_zero(mixed[1], beat=lambda fraction, time: True)
    assert run.outcome.kind == "budget" and len(run.times) == 2


def test_every_law_can_be_batched():
    laws = [Constant(1.0), Constant(2.0)]
    assert pick(stack(laws), 1) == laws[1]
    assert {Hencky} == set(ELASTIC) and NoFlow in FLOW
    for kind in (*ELASTIC, *FLOW, *LAWS):
        assert pick.dispatch(kind) is not pick.dispatch(object), kind
    tables = [table([1, 2, 3], [k, 2 * k, k]) for k in (1.0, 2.0)]
    assert all(np.array_equal(a, b) for a, b in zip(pick(stack(tables), 1), tables[1], strict=True))


PLAIN = """
import json, sys, mpm
from mpm.scene.point import run_zero
run = run_zero(mpm.load(json.loads(sys.argv[1])))
print(json.dumps({name: list(values) for name, values in run.series.items()}))
"""


def test_compiled_equals_plain_python(point):
    experiment = point(PULL, flow={"eta": 1e4}, time={"end": 1.0, "step": 0.05})
    run = run_zero(experiment)
    done = subprocess.run([sys.executable, "-c", PLAIN, json.dumps(experiment.resolved())], env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
                          capture_output=True, text=True, check=True)  # fmt: skip
    plain = json.loads(done.stdout)
    assert plain.keys() == run.series.keys()
    for name, values in plain.items():
        assert np.allclose(run.series[name], values, rtol=1e-11, atol=1e-12 * np.abs(run.series["stress_zz"]).max()), name
