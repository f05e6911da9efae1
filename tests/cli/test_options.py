import io
from types import SimpleNamespace

import pytest
from mpm_cli.numbers import lines
from mpm_cli.options import overrides, seconds, workers
from mpm_cli.progress import Bar, Plain, clock, reporter
from mpm_cli.talk import strict
from typer import BadParameter


@pytest.mark.parametrize("text, value", [("90", 90), ("90s", 90), ("1.5min", 90), ("2h", 7200), ("1 d", 86400)])
def test_durations(text, value):
    assert seconds(text) == value


@pytest.mark.parametrize("text", ["", "0", "-1", "soon", "1w", "1e3"])
def test_no_durations(text):
    with pytest.raises(BadParameter):
        seconds(text)


def test_workers():
    assert workers("3") == 3 and workers("auto") >= 1
    for text in ("0", "-1", "two", "1.5", "99999"):
        with pytest.raises(BadParameter):
            workers(text)


def test_overrides_keep_the_text():
    assert overrides(["time.end=60", " beta = 13 W/m**2/K ", "title=a=b"]) == {"time.end": "60", "beta": "13 W/m**2/K", "title": "a=b"}
    assert overrides(None) == {}


def test_strict_json():
    assert strict({"a": float("inf"), 1: (float("nan"), None, True)}) == {"a": "inf", "1": ["nan", None, True]}


LINE = {"run_id": "ab", "status": 4, "error": "diverged: [red] det F", "steps": 3, "wall_time": 0.1}


def test_plain_lines_off_a_terminal(monkeypatch):
    assert isinstance(reporter(False, False), Plain)
    out = io.StringIO()
    plain = Plain(out)
    plain.start(2, 1, 1)
    plain.finished("kappa=1", LINE, True)
    plain.finished("kappa=1", LINE | {"status": 0}, False)
    told = out.getvalue().splitlines()
    assert told == ["2 points, 1 already there", "[1/2] kappa=1: diverged: [red] det F; trying again", "[2/2] kappa=1: ok, 3 steps, 0.1 s"]


def test_a_bar_on_a_terminal_tells_failures_as_they_are(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")
    for name in ("CI", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sys.stdout", Terminal())
    bar = reporter(False, False)
    assert isinstance(bar, Bar)
    out = bar.console.file
    bar.start(4, 1, 2)
    bar.beat({})
    bar.finished("kappa=1", LINE, False)
    bar.beat({"a": 0.5, "b": 0.25})
    bar.close()
    assert "kappa=1: diverged: [red] det F" in out.getvalue() and "2 running, " in out.getvalue() and "1 failed" in out.getvalue()
    monkeypatch.setenv("NO_COLOR", "1")
    assert isinstance(reporter(False, False), Plain)


def test_clock():
    assert clock(307) == "5:07" and clock(3907) == "1:05:07"


def test_numbers_that_are_zero_are_counted_where_nothing_is_asked_for():
    experiment = SimpleNamespace(output=SimpleNamespace(observables=[], probes={}), grid=SimpleNamespace(dimension=2), bodies=["one"])
    record = SimpleNamespace(finals={"mass_total": 2.0, "energy_kinetic": 0.0})
    assert [line.split()[-1] for line in lines(record, experiment)] == ["place:", "mass_total", "--all)"]
    assert lines(record, experiment)[-1] == "  (1 more, all 0, with --all)"
    assert "energy_kinetic" in "".join(lines(record, experiment, everything=True))
