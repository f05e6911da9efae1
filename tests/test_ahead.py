"""What is compiled before a run: which kernels it will need, and that the run then needs no other."""

import pytest

import mpm
from mpm import ahead
from mpm.contact.step import advance_touching
from mpm.integrate.explicit import advance


def block(bottom, **changes):
    return mpm.load(
        {
            "grid": {"dimension": 1, "size": [0.2], "cell": 0.01},
            "bodies": {"block": {"shape": {"box": {"lower": [bottom], "upper": [bottom + 0.04]}}, "material": "m"}},
            "materials": {"m": {"density": 1000.0, "elastic": {"hencky": {"E": 1e4, "nu": 0.0}}}},
            "walls": {"left": "contact"},
            "gravity": [-9.81],
            "time": {"end": 0.2},
            "output": {"every": 0.01, "observables": ["position.min_x"]},
        },
        changes,
    )


def kernels():
    return [len(getattr(kernel, "signatures", ())) for kernel in (advance, advance_touching)]


@pytest.mark.parametrize(("bottom", "changes", "later"), [
    (0.1, {}, True), (0.0, {}, False), (0.1, {"gravity": [0.0]}, False), (0.1, {"gravity": [0.0], "bodies.block.velocity": [-1.0]}, True),
    (0.1, {"time.end": 0.01}, False),
], ids=["falls", "lies there", "floats", "is thrown", "is still in the air"])  # fmt: skip
def test_who_meets_something_later(bottom, changes, later):
    assert ahead.meets_later(*ahead.at_start(block(bottom, **changes))) is later


def test_a_run_finds_both_steps_compiled():
    experiment = block(0.03)
    ahead.compile_step(*ahead.at_start(experiment))
    ahead.compile_touching(experiment)
    before = kernels()
    run = mpm.run_point(experiment)
    assert run.outcome.ok and run.series["position_min_x"].min() < 1e-3 and kernels() == before


def test_a_second_process_is_for_an_idle_core(monkeypatch):
    monkeypatch.setattr(ahead, "cores", lambda: 2)
    for load, spare in ((0.3, True), (1.4, False)):
        monkeypatch.setattr(ahead.os, "getloadavg", lambda load=load: (load, load, load))
        assert ahead.core_to_spare() is spare
    monkeypatch.delattr(ahead.os, "getloadavg")
    assert ahead.core_to_spare()
