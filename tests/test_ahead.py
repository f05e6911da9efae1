"""When kernels are compiled at once."""

from mpm import ahead


def test_a_second_process_is_for_an_idle_core(monkeypatch):
    monkeypatch.setattr(ahead, "cores", lambda: 2)
    for load, spare in ((0.3, True), (1.4, False)):
        monkeypatch.setattr(ahead.os, "getloadavg", lambda load=load: (load, load, load))
        assert ahead.core_to_spare() is spare
    monkeypatch.delattr(ahead.os, "getloadavg")
    assert ahead.core_to_spare()
