"""When kernels are compiled at once."""

import subprocess
import sys

import numpy as np
import pytest
from mpm_cli.progress import Plain

import mpm
from mpm import ahead, compiling

STANDS = {
    "grid": {"dimension": 1, "size": [1.0], "cell": 0.125}, "gravity": [-0.1], "walls": {"left": "contact"}, "time": {"end": 1}, "output": {"every": 1},
    "bodies": {"bar": {"shape": {"box": {"lower": [0], "upper": [0.5]}}, "material": "m", "temperature": 300}}, "method": {"mechanics": "implicit"},
    "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
    "surfaces": [{"of": "bar", "convection": {"beta": 1, "outside": 400}}],
}  # fmt: skip


def test_a_second_process_is_for_an_idle_core(monkeypatch):
    monkeypatch.setattr(ahead, "cores", lambda: 2)
    for load, spare in ((0.3, True), (1.4, False)):
        monkeypatch.setattr(ahead.os, "getloadavg", lambda load=load: (load, load, load))
        assert ahead.core_to_spare() is spare
    monkeypatch.delattr(ahead.os, "getloadavg")
    assert ahead.core_to_spare()


def test_waiting_for_the_second_process_is_told_and_counts_as_compiling():
    told, before = [], compiling.seconds()
    with compiling.say(lambda text, expected, took: told.append((text, took))):
        compiling.spent.wait("heat_chebyshev", subprocess.Popen([sys.executable, "-c", "import time; time.sleep(0.2)"]))
    assert [text for text, _ in told] == ["compiling the heat step in a process beside this one, once on this machine", ""]
    assert told[1][1] >= 0.2 and compiling.seconds() - before == pytest.approx(told[1][1])


def test_what_is_compiled_beside_is_said_in_one_sentence(capsys):
    """It was `..., kernel compiling the heat step in a process beside this one, once on this machine: ...`."""
    plain = Plain(sys.stdout, False)
    with compiling.say(lambda text, expected, took: plain.compiling(text, expected)):
        compiling.spent.wait("heat_implicit", subprocess.Popen([sys.executable, "-c", ""]))
    assert capsys.readouterr().out.startswith("compiling the heat step in a process beside this one, once on this machine: about ")


@pytest.mark.plain
def test_implicit_mechanics_without_heat_are_what_is_compiled_here(monkeypatch):
    """The pair of steps that a run begins with moves the body, and warms nothing: that is left to the process beside."""
    made = []
    monkeypatch.setattr(ahead, "at_start", lambda experiment, whole=ahead.at_start: made.append(whole(experiment)) or made[-1])
    ahead.compile_step(mpm.load(STANDS))
    ((scene, clock),) = made
    assert clock.told["iterations"] > 0 and clock.heat_steps == 0 and np.all(scene.bodies[0].thermal.theta == 0)
