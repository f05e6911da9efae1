"""One point from experiment to Run: what it holds, what is refused, what it is said to cost."""

import os
import subprocess
import sys

import numpy as np
import pytest

import mpm
from mpm.records.variables import VARIABLES, describe
from mpm.runner import estimate, physics, warm

ALWAYS = {"heat_ledger", "heat_total", "heat_exchanged"}


def cooling(core, changes=None, **sections):
    return core.experiment(1, changes, surfaces=[{"of": "body", "convection": {"beta": 2.0, "outside": core.COLD}}], **sections)


def test_a_moving_run_is_whole(core):
    """Series at every output time, finals of all of them, names that the dataset knows, snapshots by particle and node."""
    output = {
        "every": 0.1,
        "probes": {"face": [1.35], "heart": [0.95]},
        "observables": ["temperature.mean", "momentum.x", "time_to.face.110_degC"],
        "snapshots": {"every": 0.2, "particles": ["position", "temperature", "body"], "grid": ["temperature", "velocity", "density"]},
    }
    run = mpm.run_point(cooling(core, output=output))
    assert run.outcome.ok and run.times == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.5])
    assert {*ALWAYS, "temperature_face", "temperature_heart", "temperature_mean", "momentum_x"} <= set(run.series)
    assert all(len(values) == 6 for values in run.series.values())
    assert all(run.finals[name] == values[-1] for name, values in run.series.items())
    for name in (*run.series, *run.finals):
        assert name in VARIABLES or describe(name).long_name
    found, face = run.finals["time_to_face_110_degC"], run.series["temperature_face"]
    k = int(np.argmax(face < 383.15))
    assert run.times[k - 1] <= found <= run.times[k]
    assert run.series["temperature_face"][-1] < run.series["temperature_heart"][-1]
    assert run.snapshot_times == pytest.approx([0, 0.2, 0.4, 0.5]) and len(run.particles) == 4
    assert run.particles[0]["position"].shape == (7, 1) and run.grid["temperature"].shape == (4, 9) and run.grid["temperature"].dtype == np.float32
    inside = np.isfinite(run.grid["temperature"][0])
    assert np.allclose(run.grid["temperature"][0][inside], core.HOT) and 4 <= inside.sum() <= 6
    assert run.axes["x"] == pytest.approx(np.arange(9) * 0.25)
    assert run.steps == run.finals["steps"] and run.wall_time > 0 and run.facts["particles"] == 7 and run.facts["binds"]


def test_a_threshold_that_is_not_reached_is_nan(core):
    output = {"every": 0.1, "probes": {"heart": [0.95]}, "observables": ["time_to.heart.305_K"]}
    run = mpm.run_point(cooling(core, output=output))
    assert run.outcome.ok and np.isnan(run.finals["time_to_heart_305_K"])


def test_physics_says_what_is_compiled(core):
    found = physics(cooling(core))
    assert {"elastic: hencky", "heat: fourier", "exchange: convection", "heating: elastic"} <= set(found["compiled"])
    assert found["absent"] == ["flow", "source", "load", "gravity"]
    bare = physics(core.experiment(1, drop=("surfaces", "expansion", "heating", "heat")))
    assert bare["compiled"] == ["elastic: hencky"] and set(bare["absent"]) == {"flow", "heat", "expansion", "heating", "exchange", "source", "load", "gravity"}


@pytest.mark.parametrize("changes", [{}, {"kappa": 1.0}, {"time.step": 0.01}])
def test_the_estimate_is_of_the_right_size(core, changes):
    """Particles exactly; steps within a factor of two or the number of records; the limit that binds is the one that the run reports."""
    experiment = cooling(core, {"output.every": 0.5} | changes)
    said, run = estimate(experiment), mpm.run_point(experiment)
    assert said["particles"] == run.facts["particles"] == 7 and said["unknowns"] == 13
    assert 0.5 <= said["steps"] / run.steps <= 2
    assert said["binds"] == {"heat pace or output": "heat pace"}.get(run.facts["binds"], run.facts["binds"])
    assert {"elastic wave", "conduction", "surface exchange"} <= set(said["limits"]) and all(limit > 0 for limit in said["limits"].values())
    assert said["memory_bytes"] > 0 and said["output_bytes"] > 0 and said["seconds"] > 0
    assert said["physics"] == physics(experiment)


def test_estimate_of_a_rigid_scene(core):
    experiment = core.experiment(1, drop=("elastic", "expansion", "heating"))
    said = estimate(experiment)
    assert said["particles"] == 0 and said["unknowns"] >= 4 and said["seconds"] < 10


def test_warming_up_compiles_what_the_run_needs(core):
    """After `warm` the same kinds run without compiling: no new signature of the step or the heat step."""
    from mpm.integrate.explicit import advance
    from mpm.integrate.heat_step import heat_step

    experiment = cooling(core)
    warm(experiment)
    before = len(getattr(advance, "signatures", ())), len(getattr(heat_step, "signatures", ()))
    assert mpm.run_point(experiment).outcome.ok
    assert before == (len(getattr(advance, "signatures", ())), len(getattr(heat_step, "signatures", ())))


def test_a_rigid_and_a_stopped_run(core):
    rigid = core.experiment(1, {"beta": 2.0}, drop=("elastic", "expansion", "heating"))
    assert mpm.run_point(rigid).outcome.ok
    assert mpm.run_point(cooling(core), lambda fraction, time: True).outcome.kind == "budget"


def test_a_run_takes_one_thread_of_blas():
    """Whoever imported NumPy, and whatever the environment says; afterwards all is as it was."""
    from threadpoolctl import threadpool_info, threadpool_limits

    def counts():
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    matter = {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0}}}}
    point = {"grid": {"dimension": 0}, "bodies": {"body": {"shape": "point", "material": "m"}}, "materials": matter,
             "loading": [{"strain_rate": {"xx": 0.1}}], "time": {"end": 1}, "output": {"every": 0.1}}  # fmt: skip
    seen = []
    with threadpool_limits(2, "blas"):
        mpm.run_point(mpm.load(point), beat=lambda *_: seen.append(counts()) and False)
        assert seen and all(one == {1} for one in seen) and counts() == {2}


def test_scipy_waits_until_it_is_needed_and_takes_one_thread_too():
    """To import it takes as long as all else that a run imports."""
    code = """
import sys
import mpm.runner
from threadpoolctl import threadpool_info
assert not {"scipy.linalg", "scipy.optimize"} & set(sys.modules)
import mpm.implicit.matrix
with mpm.runner.one_thread():
    print(sorted(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"))
"""
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ | {"OPENBLAS_NUM_THREADS": "2"}).stdout
    assert said == "[1, 1]\n"


def test_compiling_ahead_is_short_where_the_end_is_a_formula(core, monkeypatch):
    """What `warm` runs ends after a step, whatever the formulas of the config say."""
    from mpm import runner

    ran = []
    monkeypatch.setattr(runner, "run_point", ran.append)
    runner.warm(mpm.load(core.config(1, parameters={"end": 0.5}, time={"end": "=end"}, output={"every": 0.1})))
    assert ran[0].time.end == ran[0].output.every < 0.1
