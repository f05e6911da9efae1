"""When kernels are compiled at once."""

import subprocess
import sys

import pytest

from mpm import ahead, compiling


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
