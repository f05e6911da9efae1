"""R8: a run that was cut goes on with the same bits, whatever it is made of."""

from pathlib import Path

import numpy as np
import pytest
from restart import cut

import mpm
from mpm.costs import estimate
from mpm.sweep.cases import plan

CONFIGS = Path(__file__).parents[2] / "configs"
HEAT = {"fourier": {"kappa": 0.4, "alpha": {"bump": {"base": 2000.0, "heat": 1e5, "at": 350.0, "width": 5.0}}}}
LOOKS = {"every": 0.1, "probes": {"p": [0.7]}, "observables": ["time_to.p.395_K"]}
FIELDS = {"every": 0.2, "grid": ["temperature"], "particles": ["position", "temperature"]}


def slab(rigid, heat=None, **more):
    data = {
        "grid": {"dimension": 1, "size": [0.1], "cell": 2e-3},
        "bodies": {
            "one": {"shape": {"box": {"lower": [0.01], "upper": [0.04]}}, "material": "m", "temperature": 300},
            "two": {"shape": {"box": {"lower": [0.06], "upper": [0.09]}}, "material": "m", "temperature": 320},
        },
        "materials": {"m": {"density": 1000, "heat": heat or {"fourier": {"kappa": 0.4, "alpha": 2000.0}}}},
        "surfaces": [{"of": name, "convection": {"beta": 50.0, "outside": 400.0}} for name in ("one", "two")],
        "time": {"end": 200.0},
        "output": {"every": 20.0, "probes": {"p": [0.02], "q": [0.07]}, "observables": ["time_to.q.340_K"]},
        "method": {"rigid": rigid},
    }
    return mpm.load(data | more)


@pytest.mark.plain
@pytest.mark.parametrize("transfer", ["apic", "flip blend"])
def test_moving_bodies(core, transfer):
    experiment = core.experiment(
        1, {"beta": 5.0, "outside": 300.0}, output=LOOKS | {"snapshots": FIELDS}, method=core.methods(transfer) | {"heat": {"explicit": {}}}, time={"end": 1.0}
    )
    cuts, wrong = cut(experiment, 6, np.random.default_rng(1))
    assert cuts == 6 and not wrong


@pytest.mark.wide
@pytest.mark.parametrize("shared", [10**9, 1], ids=["alone", "in slabs"])
def test_bodies_whose_particles_are_sorted(core, monkeypatch, shared):
    from mpm.integrate import sorting

    for name, value in {"LEAST": 1, "MIXED": 0.0, "FAR": 0, "EVERY": 2, "SHARED": shared, "FULL": 1}.items():
        monkeypatch.setattr(sorting, name, value)
    air = [{"of": "body", "convection": {"beta": 1.0, "outside": 300}}]
    body = core.config(2)["bodies"]["body"] | {"velocity": [0.9, 0.3]}
    looks = LOOKS | {"probes": {"p": [0.7, 0.7]}}
    experiment = core.experiment(2, {"method.particles": 2, "grid.cell": 0.0625}, surfaces=air, bodies={"body": body}, output=looks, time={"end": 1.0})
    cuts, wrong = cut(experiment, 6, np.random.default_rng(5))
    assert cuts == 6 and not wrong


@pytest.mark.plain
def test_a_body_between_a_hot_wall_and_a_hot_tool():
    """What each has given goes on where it was."""
    experiment = mpm.load({
        "grid": {"dimension": 1, "size": [1.5], "cell": 0.125}, "time": {"end": 0.5}, "output": {"every": 0.05}, "gravity": [-0.01],
        "bodies": {"bar": {"shape": {"box": {"lower": [0], "upper": [0.5]}}, "material": "m", "temperature": 300}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
        "walls": {"left": {"contact": {"heat": {"beta": 2, "temperature": 350}}}},
        "tools": {"lid": {"shape": {"box": {"lower": [0.5], "upper": [0.9]}}, "motion": {"velocity": [0.2]}, "heat": {"beta": 5, "temperature": 400}}},
    })  # fmt: skip
    cuts, wrong = cut(experiment, 4, np.random.default_rng(7))
    assert cuts == 4 and not wrong


@pytest.mark.plain
@pytest.mark.wide
def test_a_block_that_slides_on_a_floor():
    """What contacts keep while little moves goes on where it was."""
    experiment = mpm.load({
        "grid": {"dimension": 2, "size": [1.5, 1.0], "cell": 0.125}, "time": {"end": 1.5}, "output": {"every": 0.07}, "gravity": [0, -0.01],
        "bodies": {"block": {"shape": {"box": {"lower": [0.3, 0], "upper": [0.8, 0.4]}}, "material": "m", "velocity": [0.004, 0]}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}}}, "walls": {"bottom": {"contact": {"friction": 0.2}}},
    })  # fmt: skip
    cuts, wrong = cut(experiment, 6, np.random.default_rng(9))
    assert cuts == 6 and not wrong


@pytest.mark.plain
def test_a_run_that_goes_over_to_another_frame():
    """`method.frame: auto`: cut before and after."""
    experiment = mpm.load({
        "grid": {"dimension": 1, "size": [2.0], "cell": 0.25}, "time": {"end": 1.0}, "method": {"frame": "auto"}, "output": {"every": 0.1},
        "bodies": {"bar": {"shape": {"box": {"lower": [0.5], "upper": [1.5]}}, "material": "m", "velocity": [0.9]}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}}},
    })  # fmt: skip
    cuts, wrong = cut(experiment, 20, np.random.default_rng(6))
    assert cuts >= 8 and not wrong


@pytest.mark.parametrize("rigid, heat", [({"implicit": {}}, None), ({"implicit": {}}, HEAT), ({"explicit": {}}, HEAT)], ids=["linear", "newton", "chebyshev"])
def test_bodies_that_do_not_move(rigid, heat):
    cuts, wrong = cut(slab(rigid, heat), 6, np.random.default_rng(2))
    assert cuts == 6 and not wrong


def test_material_points():
    experiment = mpm.load(CONFIGS / "scenes" / "dough_rheometer.yaml", {}, smoke=True)
    cuts, wrong = cut(plan(experiment).cases[0].experiment, 3, np.random.default_rng(3))
    assert cuts == 3 and not wrong


@pytest.mark.parametrize("field", ["time", "exchanged", "steps"])
def test_a_memory_that_lost_something_is_seen(core, field, monkeypatch):
    """The comparison is sharp: with one number of the memory wrong, the runs differ."""
    from mpm.simulation import Clock

    whole = Clock.recall

    def lossy(clock, found):
        whole(clock, found)
        vars(clock)[field] = type(vars(clock)[field])(vars(clock)[field] * 0.75)

    monkeypatch.setattr(Clock, "recall", lossy)
    experiment = core.experiment(1, {"beta": 5.0, "outside": 300.0}, output=LOOKS, method=core.methods("apic") | {"heat": {"explicit": {}}}, time={"end": 1.0})
    _, wrong = cut(experiment, 3, np.random.default_rng(4))
    assert wrong


def brief(path):
    """A config's first point, by its smoke section, or else with so much less time that a run takes about a second."""
    experiment = mpm.load(path)
    if experiment.smoke is not None:
        experiment = mpm.load(path, {}, smoke=True)
    elif (seconds := estimate(plan(experiment).cases[0].experiment)["seconds"]) > 1.0:
        experiment = mpm.load(path, {"time.end": experiment.time.end / seconds, "output.every": experiment.output.every / seconds})
    return plan(experiment).cases[0].experiment


@pytest.mark.slow
def test_200_random_cuts_over_all_scenes(table):
    rng, made, wrong, seen = np.random.default_rng(8), 0, [], 0
    paths = sorted(CONFIGS.rglob("*.yaml"))
    for path in paths:
        cuts, differ = cut(brief(path), -(-200 // len(paths)) + 1, rng)
        print(path.stem, cuts, differ, flush=True)
        made, seen, wrong = made + cuts, seen + (cuts > 0), wrong + [(path.stem, differ)] * bool(differ)
    table(f"restart at {made} random cuts over {seen} of {len(paths)} configs", f"{len(wrong)} differ in any bit of any array")
    assert made >= 200 and not wrong
