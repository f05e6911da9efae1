"""Blocks of steps are cut short where that keeps everything apart: contacts are looked for, and compiled, once something is near."""

from pathlib import Path

import numpy as np
import pytest

import mpm.contact.block as block
from mpm.contact.meeting import Meeting

pytestmark = pytest.mark.plain


def bar(core, end, step=0.02):
    """0.6 before a wall, at which it flies with 0.4."""
    body = {"shape": {"box": {"lower": [0.6], "upper": [1.35]}}, "material": "solid", "velocity": [-0.4]}
    changes = {"time.step": step, "time.end": end, "output.every": end}
    return core.experiment(1, changes, ("surfaces", "expansion", "heating", "heat"), bodies={"body": body}, walls={"left": "contact"})


def thrown(core, monkeypatch, end, fewest=block.FEWEST):
    """(run of the bar, times of the blocks that looked for contacts)."""
    looked, advance = [], Meeting.advance
    monkeypatch.setattr(Meeting, "advance", lambda self, *around: (looked.append(around[3]), advance(self, *around)))
    monkeypatch.setattr(block, "FEWEST", fewest)
    run = core.play(bar(core, end))[1]
    monkeypatch.undo()
    assert run.outcome.ok
    return run, looked


def test_what_stops_short_of_a_wall_is_not_looked_at(core, monkeypatch):
    """It ends 0.12 before the wall, which blocks of 32 steps could cross; with them the result is the same to round-off."""
    (run, looked), (long, looks) = thrown(core, monkeypatch, 1.2), thrown(core, monkeypatch, 1.2, fewest=10**6)
    assert looked == [] and len(looks) > 0
    assert run.series["position_mean_x"] == pytest.approx(long.series["position_mean_x"], rel=1e-12)


def test_what_reaches_the_wall_is(core, monkeypatch):
    """It turns back as with long blocks: contacts were looked for before it touched."""
    (run, looked), (long, looks) = thrown(core, monkeypatch, 2.4), thrown(core, monkeypatch, 2.4, fewest=10**6)
    assert 0 < min(looks) < min(looked) < 0.6 / 0.4
    assert run.finals["momentum_x"] > 0 and run.finals["momentum_x"] == pytest.approx(long.finals["momentum_x"], rel=1e-3)
    assert np.min(run.series["position_min_x"]) > -0.01


def test_a_run_that_is_cut_goes_on_with_the_same_bits(core, monkeypatch):
    """Wherever: far from the wall, in blocks that were cut short, and while it touches."""
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "faults")
    from restart import cut

    cuts, wrong = cut(bar(core, 2.0, 0.008), 12, np.random.default_rng(0))
    assert cuts >= 10 and wrong == []
