"""Every config that ships loads, says what it is for, and runs to the end in its short form."""

import re
import time
from pathlib import Path

import pytest

import mpm
from mpm import compiling

ROOT = Path(__file__).parent.parent / "configs"
CONFIGS = sorted(path for path in ROOT.rglob("*.yaml"))
each = pytest.mark.parametrize("path", CONFIGS, ids=lambda path: str(path.relative_to(ROOT)))
HEADINGS = ("Purpose", "Cost", "Source")


def test_there_are_configs():
    assert len(CONFIGS) >= 4


@each
def test_it_says_what_it_is_for(path):
    """The schema line for editors first, then purpose, cost and source as comments."""
    lines = path.read_text(encoding="utf-8").splitlines()
    assert re.fullmatch(r"# yaml-language-server: \$schema=(\.\./)*schema\.json", lines[0])
    assert (path.parent / lines[0].split("=")[1]).resolve() == (ROOT / "schema.json").resolve()
    comments = [line.lstrip("# ") for line in lines[1:] if line.startswith("#")]
    for heading in HEADINGS:
        said = [line for line in comments if line.startswith(heading)]
        assert said and len(said[0]) > len(heading) + 10, heading


@pytest.mark.parametrize("path", sorted((ROOT / "scenes").glob("*.yaml")), ids=lambda path: path.stem)
def test_a_scene_says_what_is_fitted_and_what_predicted(path):
    from mpm.starting.scenes import read

    assert len(read(path).trust) > 40


@each
def test_it_loads_and_plans(path):
    experiment = mpm.load(path)
    assert experiment.title and experiment.name == path.stem
    assert mpm.plan(experiment).cases


def heat_scale(experiment, run):
    """What the ledger is measured by [J]: the heat exchanged, or, where little is, what the spread of temperatures holds."""
    spread = max(run.series["temperature_max"]) - min(run.series["temperature_min"])
    held = 0.0
    for body in experiment.bodies.values():
        alpha = experiment.materials[body.material].heat.alpha
        held = max(held, alpha.value if type(alpha).kind == "constant" else 0.0)
    return max(abs(run.series["heat_exchanged"]).max(), abs(run.series["heat_total"]).max(), held * spread * run.series.get("mass_total", [0.0])[0])


SLOW = ("verification", "stability", "studies", "reduction")  # a compilation each
ALONE = ("lava_cake", "press_tpa", "ball_on_slab", "burger_cheese")  # scenes whose physics no other compiles
WIDE = (
    "cake_in_pan", "chocolate_melt", "chocolate_pour", "chocolate_pour_fit", "cookie_spread", "cube", "dough_creep", "dough_rheometer", "dough_rheometer_fit",
    "hearth_loaf", "loaf_oven_spring", "pancake", "tin_loaf",
)  # fmt: skip


def level(path):
    """Which of the tests a config's short form belongs to."""
    if path.parent.name in SLOW or path.stem in ALONE:
        return [pytest.mark.slow]
    return [pytest.mark.wide] if path.stem in WIDE else []


SHORT = [pytest.param(path, marks=level(path)) for path in CONFIGS]


@pytest.mark.parametrize("path", SHORT, ids=lambda path: str(path.relative_to(ROOT)))
def test_its_short_form_runs(path):
    """The first point of --smoke (or of a config that is short already), in under 10 s once compiled."""
    experiment = mpm.load(path)
    experiment = mpm.load(path, smoke=True) if experiment.smoke else experiment
    point = mpm.plan(experiment).cases[0].experiment
    from mpm.runner import warm

    warm(point)
    began, compiled = time.process_time(), compiling.seconds()
    run = mpm.run_point(point)
    assert run.outcome.ok, run.outcome
    assert time.process_time() - began - (compiling.seconds() - compiled) < 10  # bodies that meet on the way compile their contact then
    assert run.times[-1] == pytest.approx(point.time.end)
    if "heat_ledger" in run.series:
        assert abs(run.series["heat_ledger"]).max() <= 1e-12 * heat_scale(point, run)


@pytest.mark.slow
def test_slump_has_no_warnings_over_its_whole_sweep(tmp_path):
    """The first scene that a new user sweeps: every point ok, and nothing that a careful user would want to know of."""
    tree = mpm.sweep(mpm.load(ROOT / "scenes" / "slump.yaml"), out=tmp_path / "slump", jobs=2)
    assert tree.status.size == 32 and (tree.status == 0).all()
    assert not [text for text in tree.warnings.values.ravel() if text]
