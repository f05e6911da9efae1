"""Heat from within and body forces (`sources`): exact cases in every solver, what is refused, restarts."""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.benchmarks.verification import refinement
from mpm.runner import run_point
from mpm.scene.refusal import SceneError

FOLDER = Path(__file__).parents[2] / "configs" / "verification"
SLAB = {
    "grid": {"dimension": 1, "size": [2.0], "cell": 0.125},
    "bodies": {"slab": {"shape": {"box": {"lower": [0.4], "upper": [1.4]}}, "temperature": 300, "material": "m"}},
    "materials": {"m": {"density": 2.0, "heat": {"fourier": {"kappa": 1.0, "alpha": 1.5}}}},
    "time": {"end": 0.4},
    "output": {"every": 0.1},
}
MOVES = {"materials": {"m": SLAB["materials"]["m"] | {"elastic": {"hencky": {"E": 10.0, "nu": 0.0}}}}}
PUSH = {"table": {"time": [0.0, 0.2, 0.2, 0.4], "value": [0.0, 0.1, -0.15, 0.0]}}
JUMPS = {"table": {"time": [0.0, 0.13, 0.13, 0.4], "value": [5.0, 5.0, -2.0, 1.0]}}


def final_errors(name, field):
    _, cells, points = refinement(mpm.load(FOLDER / f"{name}.yaml"))
    runs = [run_point(point) for point in points]
    assert all(run.outcome.ok for run in runs)
    errors = [run.finals[field] for run in runs]
    return np.polyfit(np.log(cells), np.log(errors), 1)[0], errors, runs


@pytest.mark.parametrize(("name", "most"), [("heated_slab", 2e-4), ("posed_heat", 5e-3)])
def test_bodies_that_do_not_move(name, most):
    """A microwave-heated slab and a manufactured square: order 2 and better on nodes, the ledger to rounding."""
    order, errors, runs = final_errors(name, "error_l2")
    assert order > 2.5 and errors[-1] < most
    for run in runs:
        assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * max(1.0, np.abs(run.series["heat_exchanged"]).max())  # the square's sums to nothing


@pytest.mark.parametrize("rigid", ["implicit", "explicit", "bounded"])
def test_every_rigid_solver_takes_programmes_and_formulas_alike(rigid):
    """A ramp by table and by formula, in parts that jump: what it gives is its integral, and steps end on the jump."""
    given = 5.0 * 0.13 + 0.27 * (-2.0 + 1.0) / 2
    formula = [{"of": "slab", "heat": {"formula": "5"}, "until": 0.13}, {"of": "slab", "heat": {"formula": "-2 + 3*(t - 0.13)/0.27"}, "from": 0.13}]
    found = []
    for sources in ([{"of": "slab", "heat": JUMPS}], formula, [{"of": "slab", "heat_by_mass": {"table": JUMPS["table"] | {"value": [2.5, 2.5, -1.0, 0.5]}}}]):
        run = run_point(mpm.load(SLAB | {"sources": sources, "method": {"rigid": rigid}}))
        assert run.outcome.ok and run.finals["heat_exchanged"] == pytest.approx(given, rel=1e-12)
        assert run.finals["temperature_mean"] == pytest.approx(300 + given / 3.0, rel=1e-12)
        found.append(run.finals["temperature_max"])
    assert found == pytest.approx([found[0]] * 3, rel=1e-12)


def test_bodies_that_conduct_into_one_another():
    """Two halves of a slab of which one is heated: each body's books, and the steady rise towards the cold side."""
    half = [{"shape": {"box": {"lower": [a], "upper": [a + 0.5]}}, "temperature": 300, "material": "m"} for a in (0.4, 0.9)]
    scene = SLAB | {"bodies": {"a": half[0], "b": half[1]}, "time": {"end": 20.0}, "surfaces": [{"of": "b", "side": "right", "fixed": {"temperature": 300}}]}
    scene |= {"sources": [{"of": "a", "heat": {"formula": "4 + 0*t"}}], "output": {"every": 5.0, "probes": {"in": [0.4], "face": [0.9]}}}
    run = run_point(mpm.load(scene))
    assert run.finals["temperature_face"] == pytest.approx(300 + 4 * 0.5 * 0.5, abs=1e-3)  # the flux q L through the other half
    assert run.finals["temperature_in"] == pytest.approx(300 + 4 * 0.5 * 0.5 + 4 * 0.5**2 / 2, abs=1e-3)
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_total"]).max()
    cooled = run_point(mpm.load(scene | {"surfaces": [{"of": "b", "side": "right", "convection": {"beta": 10, "outside": 300}}]}))
    assert cooled.finals["temperature_face"] == pytest.approx(300 + 4 * 0.5 * (0.5 + 1 / 10), abs=1e-3)
    assert np.abs(cooled.series["heat_ledger"]).max() < 1e-12 * np.abs(cooled.series["heat_total"]).max()


@pytest.mark.plain
def test_a_material_point():
    """A lumped body heated from within, exact in any step; without exchange it warms by q t/(rho alpha)."""
    point = {"grid": {"dimension": 0}, "bodies": {"p": {"shape": {"point": {"surface_to_volume": 25}}, "temperature": 300, "material": "m"}}}
    scene = SLAB | point | {"sources": [{"of": "p", "heat": 6.0}]}
    warm = run_point(mpm.load(scene))
    assert warm.series["temperature_mean"] == pytest.approx(300 + 2.0 * warm.times, rel=1e-14)
    cooled = run_point(mpm.load(scene | {"surfaces": [{"of": "p", "convection": {"beta": 0.4, "outside": 290}}]}))
    level, rate = 290 + 6.0 / 10.0, 10.0 / 3.0
    assert cooled.series["temperature_mean"] == pytest.approx(level + (300 - level) * np.exp(-rate * cooled.times), rel=1e-13)
    assert np.abs(cooled.series["heat_ledger"]).max() < 1e-12


@pytest.fixture(scope="module")
def moving(plain):
    """Small moving scenes with sources, without the compiler."""
    bar = json.loads(json.dumps(mpm.load(FOLDER / "posed_bar.yaml", {"sweep": None}).resolved()))
    slab = SLAB | MOVES
    melts = MOVES["materials"]["m"] | {"heat": {"fourier": {"kappa": 1.0, "alpha": {"bump": {"base": 1.5, "heat": 20.0, "at": 305, "width": 1}}}}}
    swing = [{"of": "slab", "force": [{"sine": {"mean": 0, "amplitude": 0.1, "period": 0.8}}]}]
    pushed = {
        "sources": swing,
        "walls": {"left": "contact", "right": "contact"},
        "loads": [{"of": "slab", "drag": {"rate": 0.5}}],
        "time": {"end": 0.4, "step": 2e-3},
    }
    scenes = {
        "bar 8": bar | {"grid": bar["grid"] | {"cell": 0.125}},
        "bar 16": bar | {"grid": bar["grid"] | {"cell": 0.0625}},
        "jump": slab | {"sources": [{"of": "slab", "heat": JUMPS}]},
        "grows": slab | {"sources": [{"of": "slab", "heat": {"formula": "3*2*(T - 200)"}}], "time": {"end": 0.1}, "output": {"every": 0.05}},
        "latent": slab | {"sources": [{"of": "slab", "heat": 900.0}], "time": {"end": 0.1}, "output": {"every": 0.05}, "materials": {"m": melts}},
        "pushed": slab | pushed,
        "single": slab | {"sources": [{"of": "slab", "heat": JUMPS}], "method": {"precision": "float32"}, "time": {"end": 0.4, "step": 1e-3}},
        "implicit": slab | {"sources": [{"of": "slab", "force": [PUSH], "until": 0.32}], "method": {"mechanics": "implicit"}, "time": {"end": 0.4}},
        "total": slab | {"sources": [{"of": "slab", "heat": JUMPS}], "method": {"frame": "total"}},
    }  # fmt: skip
    return dict(zip(scenes, plain(list(scenes.values())), strict=True))


def test_a_manufactured_motion_that_the_config_poses(moving):
    """Order 2 in the cell at strain 0.16, as the built-in manufactured motion."""
    errors = [moving[name]["series"]["error_displacement_l2"].max() for name in ("bar 8", "bar 16")]
    assert np.log2(errors[0] / errors[1]) > 1.9 and errors[1] < 2e-4


@pytest.mark.parametrize("name", ["jump", "total"])
def test_heat_from_within_particles(moving, name):
    """An insulated slab takes up the integral of its programme, and nothing else: to rounding, across a jump."""
    run = moving[name]
    given = 5.0 * 0.13 + 0.27 * (-2.0 + 1.0) / 2
    assert run["kind"] == "completed"
    assert run["series"]["heat_exchanged"][-1] == pytest.approx(given, rel=1e-9)
    assert run["series"]["temperature_mean"][-1] == pytest.approx(300 + given / 3.0, rel=1e-9)
    assert np.abs(run["series"]["heat_ledger"]).max() < 1e-11


def test_no_heat_is_lost_to_single_precision(moving):
    """400 steps of a few thousandths of a kelvin on 300 K: what float32 has no digits for is kept for the next step."""
    given = 5.0 * 0.13 + 0.27 * (-2.0 + 1.0) / 2
    assert moving["single"]["series"]["temperature_mean"][-1] - 300 == pytest.approx(given / 3.0, rel=2e-5)


def test_a_law_of_temperature(moving):
    """q = 2 rho alpha (T - 200): the difference grows as exp(2 t)."""
    run = moving["grows"]
    assert run["series"]["temperature_mean"][-1] == pytest.approx(200 + 100 * np.exp(0.2), abs=0.01)
    assert run["series"]["temperature_max"] == pytest.approx(run["series"]["temperature_min"], rel=1e-12)


def test_no_step_jumps_over_latent_heat(moving):
    """45 J/kg through a bump of 20 J/kg: what is left over is sensible."""
    assert moving["latent"]["series"]["temperature_mean"][-1] == pytest.approx(300 + (45 - 20) / 1.5, abs=0.01)


def test_a_force_beside_a_drag(moving):
    """A free slab: p' = m b(t) - rate p, and the work of the force is in the books."""
    run = moving["pushed"]
    t, m, w, a, r = run["times"], run["series"]["mass_total"][0], 2 * np.pi / 0.8, 0.1, 0.5
    exact = a / (r * r + w * w) * (r * np.sin(w * t) - w * np.cos(w * t) + w * np.exp(-r * t))
    assert run["kind"] == "completed" and run["series"]["momentum_x"] / m == pytest.approx(exact, abs=2e-3 * a)
    lag = 0.5 * 2e-3 * m * 0.4 * a * a / 2  # work is told with the speed at the end of each step
    assert run["series"]["work_loads"][-1] == pytest.approx(run["series"]["energy_total"][-1], abs=lag) and run["series"]["energy_total"][-1] > 50 * lag


def test_a_force_in_steps_of_implicit_mechanics(moving):
    """A ramp that jumps and ends, on a free slab: velocity is its integral to rounding, as steps end on jumps; the place to what the steps are long."""
    run = moving["implicit"]
    t, m = run["times"], run["series"]["mass_total"][0]
    late = np.clip(t - 0.2, 0.0, 0.12)
    exact = 0.25 * np.minimum(t, 0.2) ** 2 - 0.15 * late + 0.375 * late**2
    assert run["kind"] == "completed" and np.abs(exact).max() > 4e-3
    assert run["series"]["momentum_x"] / m == pytest.approx(exact, abs=1e-14)


REFUSED = [
    ({"sources": [{"of": "slab", "heat": {"formula": "T"}}]}, "sources.0.heat.formula", "does not move|do not move"),
    ({"sources": [{"of": "slab", "heat": {"formula": "y"}}]}, "sources.0.heat.formula", "knows no 'y'"),
    ({"sources": [{"of": "slab", "heat": {"formula": "open(1)"}}]}, "sources.0.heat.formula", "may not hold"),
    ({"sources": [{"of": "slab", "heat": {"formula": "not x"}}]}, "sources.0.heat.formula", "may not hold"),
    ({"sources": [{"of": "slab", "heat": {"formula": "'a'*x"}}]}, "sources.0.heat.formula", "may not hold"),
    ({"exact": {"formulas": {"temperature": "300 + q*x"}}}, "exact.formulas.temperature", "knows no 'q'"),
    ({"sources": [{"of": "slab", "force": [1.0]}]}, "sources.0.force", "no elastic law"),
    ({"sources": [{"of": "slab"}]}, "sources.0", "does not say what it gives"),
    ({"sources": [{"of": "slap", "heat": 1.0}]}, "sources.0.of", "no such body"),
    ({"sources": [{"of": "slab", "heat": 1.0, "from": 2, "until": 1}]}, "sources.0.until", "before it begins"),
    (MOVES | {"sources": [{"of": "slab", "force": [1.0, 2.0]}]}, "sources.0.force", "1 number"),
    (MOVES | {"sources": [{"of": "slab", "force": [1.0]}], "method": {"frame": "total"}}, "sources.0.force", "total frame"),
    (MOVES | {"sources": [{"of": "slab", "heat": 1.0}], "method": {"mechanics": "implicit"}}, "sources.0.heat", "implicit mechanics"),
    (MOVES | {"sources": [{"of": "slab", "heat": 1.0}], "time": {"end": 1.0, "scale": 10}}, "sources.0", "time scaling"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "path", "said"), REFUSED)
def test_refused_with_a_place(changes, path, said):
    with pytest.raises(mpm.ConfigError, match=f"(?s){path}.*({said})"):
        mpm.load(SLAB | changes)


def test_a_formula_without_a_value_is_refused():
    with pytest.raises(SceneError, match="no finite value"):
        run_point(mpm.load(SLAB | {"sources": [{"of": "slab", "heat": {"formula": "sqrt(x - 1)"}}]}))


def test_a_run_cut_across_a_jump_goes_on_with_the_same_bits():
    sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
    cut = importlib.import_module("restart").cut
    sources = [{"of": "slab", "heat": JUMPS}, {"of": "slab", "heat": {"formula": "x*t"}, "from": 0.2}]
    for rigid in ({"implicit": {}}, {"explicit": {}}):
        surfaces = [{"of": "slab", "side": "right", "convection": {"beta": {"table": {"time": [0, 0.3, 0.3, 1], "value": [1, 1, 5, 5]}}, "outside": 290}}]
        cuts, wrong = cut(mpm.load(SLAB | {"sources": sources, "surfaces": surfaces, "method": {"rigid": rigid}}), 6, np.random.default_rng(3))
        assert cuts == 6 and not wrong


@pytest.mark.slow
def test_moving_scenes_compiled():
    """The same numbers from the compiler: order of the slab as particles, and a run that is cut."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
    cut = importlib.import_module("restart").cut
    order, errors, _ = final_errors("heated_slab_particles", "error_l2")
    assert order > 1.7 and errors[-1] < 1e-3
    both = [{"of": "slab", "heat": JUMPS, "force": [{"formula": "0.1*sin(7*t)"}]}]
    cuts, wrong = cut(mpm.load(SLAB | MOVES | {"sources": both, "loads": [{"of": "slab", "drag": {"rate": 0.5}}]}), 6, np.random.default_rng(4))
    assert cuts == 6 and not wrong
