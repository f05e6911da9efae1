"""The exact solutions against independent tables, what they refuse, and the error that a run reports."""

import numpy as np
import pytest

import mpm
from mpm.verification import EXACT, exact_solution, robin_cylinder, robin_slab


def problem(kind, biot, dimension=None, **changes):
    """Radius or half-thickness 1, all coefficients 1, from 1 to 0: temperatures are shifted by 300 K, which may not be 0."""
    dimension = dimension or (1 if kind == "slab" else 2)
    shape = {1: {"box": {"lower": [0.5], "upper": [2.5]}}, 2: {"ball": {"centre": [1.5, 1.5], "radius": 1.0}}}.get(
        dimension, {"cylinder": {"radius": 1.0, "height": 1.0, "base": [0, 0.5]}}
    )
    D = 1 if dimension == 1 else 2
    data = {
        "grid": {"dimension": dimension, "size": [3.0] * D, "cell": 0.125},
        "bodies": {"it": {"shape": shape, "temperature": 301.0, "material": "unit"}},
        "materials": {"unit": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
        "surfaces": [{"of": "it", "side": "lateral" if dimension == "axisymmetric" else "all", "convection": {"beta": biot, "outside": 300.0}}],
        "time": {"end": 0.2},
        "output": {"every": 0.1},
        "exact": {f"robin_{kind}": {}},
    }
    return mpm.load(data | changes)


@pytest.mark.parametrize("kind", ["slab", "cylinder"])
def test_series_against_the_table(core, kind):
    rows = [row for row in core.table("heat_robin.csv") if row["geometry"] == kind]
    assert len(rows) > 20
    s = np.array([0.0, 0.5, 1.0])
    for row in rows:
        biot = row["Bi"] if row["Bi"] != "inf" else ".inf"
        x = (1.5 + s)[:, None] if kind == "slab" else np.stack([1.5 + s, np.full(3, 1.5)], axis=1)
        found = exact_solution(problem(kind, biot))(x, row["Fo"]) - 300.0
        assert found == pytest.approx([row["theta_centre"], row["theta_half"], row["theta_surface"]], abs=2e-9), row


def test_the_start_is_uniform_and_offsets_move_the_solution():
    moved = problem("slab", 1.0, method={"offset": [0.4]})
    x = np.array([[0.6], [1.5], [2.4]])
    assert np.array_equal(exact_solution(moved)(x, 0.0), [301.0] * 3)
    assert exact_solution(moved)(x + 0.05, 0.1) == pytest.approx(exact_solution(problem("slab", 1.0))(x, 0.1), abs=1e-12)


@pytest.mark.parametrize(("side", "still"), [("left", 2.5), ("right", 0.5)])
def test_a_slab_that_exchanges_on_one_side_is_half_of_one_that_does_on_both(side, still):
    half = problem("slab", 1.0, surfaces=[{"of": "it", "side": side, "convection": {"beta": 1.0, "outside": 300}}])
    s = np.linspace(0.0, 1.0, 5)
    found = exact_solution(half)((still + np.sign(1.5 - still) * 2 * s)[:, None], 0.4)
    assert found == pytest.approx(exact_solution(problem("slab", 2.0))((1.5 + s)[:, None], 0.1), abs=1e-12)


@pytest.mark.parametrize("biot", [1e-3, 1.0, 1e3, np.inf])
def test_roots_are_ordered_and_solve_their_equation(biot):
    from scipy.special import j0, j1

    cases = [
        (robin_slab.roots(biot, 30), lambda z: z * np.sin(z) - biot * np.cos(z)),
        (robin_cylinder.roots(biot, 30), lambda z: z * j1(z) - biot * j0(z)),
    ]
    for z, residual in cases:
        assert np.all(np.diff(z) > 2.5) and len(z) == 30
        if np.isfinite(biot):
            assert np.abs(residual(z)).max() < 1e-10 * (1 + biot)


def beside(upper):
    """The slab, and another body from its end or farther on."""
    box = {"it": (0.5, 2.5), "other": (upper, 3.0)}
    bodies = {name: {"shape": {"box": {"lower": [low], "upper": [high]}}, "temperature": 301.0, "material": "unit"} for name, (low, high) in box.items()}
    return problem("slab", 1.0, bodies=bodies, exact={"robin_slab": {"body": "it"}})


def on_a_hot_wall():
    moves = {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}
    return problem("slab", 1.0, materials={"unit": moves}, walls={"left": {"contact": {"heat": {"beta": 2, "temperature": 300}}}})


REFUSED = {
    "other lies beside it": lambda: beside(2.5),
    "knows no hot walls": on_a_hot_wall,
    "needs a box": lambda: problem("slab", 1.0, dimension=2),
    "robin_cylinder needs": lambda: problem("cylinder", 1.0, dimension=1),
    "one surface": lambda: problem("slab", 1.0, surfaces=[{"of": "it", "side": s, "convection": {"beta": 1, "outside": 300}} for s in ("left", "right")]),
    "with side lateral": lambda: problem("cylinder", 1.0, "axisymmetric", surfaces=[{"of": "it", "convection": {"beta": 1, "outside": 300}}]),
    "constant kappa": lambda: problem(
        "slab", 1.0, materials={"unit": {"density": 1, "heat": {"fourier": {"kappa": {"logistic": {"low": 1, "high": 2, "at": 300, "width": 1}}, "alpha": 1}}}}
    ),
}


@pytest.mark.parametrize("words", REFUSED)
def test_a_scene_that_is_not_the_problem_is_refused(words):
    with pytest.raises(ValueError, match=words):
        exact_solution(REFUSED[words]())


def test_another_body_far_away_changes_nothing():
    assert exact_solution(beside(2.75)) is not None


def test_no_exact_solution_is_none():
    assert exact_solution(mpm.load(problem("slab", 1.0).resolved() | {"exact": None})) is None


def test_every_problem_declares_its_order():
    """None where the answer is exact at any step."""
    import importlib

    for kind in EXACT:
        module = importlib.import_module(f"mpm.verification.{kind}")
        assert module.exact is EXACT[kind] and (module.ORDER is None or module.ORDER > 0)


@pytest.mark.parametrize(("kind", "dimension"), [("slab", 1), ("cylinder", 2), ("cylinder", "axisymmetric")])
def test_a_rigid_run_reports_its_error(kind, dimension):
    run = mpm.run_point(problem(kind, 1.0, dimension))
    assert run.outcome.ok and 0 < run.finals["error_l2"] <= run.finals["error_max"] < 2e-3


def test_a_moving_run_reports_its_error(core):
    """The same slab as particles at rest."""
    body = {"body": {"shape": {"box": {"lower": [0.5], "upper": [2.5]}}, "temperature": core.HOT, "material": "solid"}}
    air = [{"of": "body", "convection": {"beta": 1.0, "outside": core.COLD}}]
    grid = {"dimension": 1, "size": [3.0], "cell": 0.125}
    changes = {"kappa": 1.0, "alpha": 1.0, "materials.solid.density": 1.0, "time.end": 0.2}
    run = mpm.run_point(core.experiment(1, changes, grid=grid, bodies=body, surfaces=air, exact={"robin_slab": {}}))
    assert run.outcome.ok and run.series["error_l2"][0] == 0.0
    assert 0 < run.finals["error_l2"] < 100 * 1.5e-3 and run.finals["error_l2"] <= run.finals["error_max"]


def test_errors_are_taken_where_the_body_has_gone(core):
    """The same slab, three cells further at the end: as at rest, but for what its way across the grid costs."""
    body = {"body": {"shape": {"box": {"lower": [0.5], "upper": [2.5]}}, "temperature": core.HOT, "material": "solid"}}
    air = [{"of": "body", "convection": {"beta": 1.0, "outside": core.COLD}}]
    unit = {"kappa": 1.0, "alpha": 1.0, "materials.solid.density": 1.0, "time.end": 0.2, "output.every": 0.1}
    sections = {"grid": {"dimension": 1, "size": [3.0], "cell": 0.0625}, "bodies": body, "surfaces": air, "exact": {"robin_slab": {}}}
    rest, thrown = (mpm.run_point(core.experiment(1, unit | more, **sections)) for more in ({}, {"bodies.body.velocity": [0.9]}))
    assert thrown.outcome.ok and rest.finals["error_l2"] < 0.1 and thrown.finals["error_l2"] < 2 * rest.finals["error_l2"]


def test_what_does_not_fit_is_told_as_advice():
    """A plate is no cylinder: the point fails with what to change, without the name of an exception or of a file."""
    from mpm.sweep.worker import compute

    plate = {
        "grid": {"dimension": 2, "size": [1.0, 1.0], "cell": 0.1},
        "bodies": {"plate": {"shape": {"box": {"lower": [0.2, 0.2], "upper": [0.8, 0.8]}}, "temperature": 300.0, "material": "stuff"}},
        "materials": {"stuff": {"density": 1000.0, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000.0}}}},
        "surfaces": [{"of": "plate", "convection": {"beta": 10.0, "outside": 290.0}}],
        "time": {"end": 100.0},
        "output": {"every": 10.0},
        "exact": "robin_cylinder",
    }
    record = compute("it", lambda: mpm.load(plate), "mpm.runner", None)
    assert record.error.startswith("failed: <dict>: exact: robin_cylinder needs a ball") and record.error.endswith("or make the scene its problem")
