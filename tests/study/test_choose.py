"""`mpm plan --tol`: the method from the fronts, the cell from pilots."""

import math

import pytest

import mpm
from mpm.study.choose import choose, numerical, physics, rank, reach
from mpm.study.figures import STUDIES
from mpm.study.pilots import NoChoice, grids, refine
from mpm.study.promises import PROBLEMS, rivals

SLAB = {
    "title": "Slab",
    "grid": {"dimension": 1, "size": [3.0], "cell": 0.25},
    "bodies": {"slab": {"shape": {"box": {"lower": [0.5], "upper": [2.5]}}, "temperature": 301, "material": "unit"}},
    "materials": {"unit": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
    "surfaces": [{"of": "slab", "convection": {"beta": 10, "outside": 300}}],
    "time": {"end": 0.2},
    "output": {"every": 0.1},
    "exact": {"robin_slab": {}},
}

IMPLICIT = {"method.rigid": {"implicit": {"order": 4, "tolerance": 1e-4}}}


def row(method, error, seconds, study="one", **settings):
    return {"study": study, "physics": "rigid", "method": method, "set": settings, "cell": 1.0, "error": error, "seconds": seconds}


def test_the_method_that_reaches_the_tolerance_first_over_all_charts():
    fast = [row("fast", 0.1, 1.0, a=1), row("fast", 0.01, 10.0, a=1), row("fast", 0.2, 1.0, "two", a=1), row("fast", 0.01, 20.0, "two", a=1)]
    slow = [row("slow", 0.01, 12.0, a=2), row("slow", 0.01, 11.0, "two", a=2)]
    assert [found[0] for found in rank("rigid", 0.1, fast + slow)] == ["fast", "slow"]
    assert [found[0] for found in rank("rigid", 0.01, fast + slow)] == ["slow", "fast"]
    assert [found[0] for found in rank("rigid", 1e-3, fast + slow)] == []
    assert reach(fast[:2], 0.1**1.5) == pytest.approx(10**0.5)
    assert reach(fast[:2], 0.005) == pytest.approx(20.0)  # a little beyond the finest, by the last slope
    assert math.isinf(reach(fast[:2], 1e-3))


def test_settings_with_steps_of_their_own_are_measured_by_and_not_chosen():
    stepped = row("stepped", 1e-4, 0.1, a=1) | {"steps": {"method.heat_step": 0.1}}
    assert [found[0] for found in rank("rigid", 0.01, [stepped, row("automatic", 1e-3, 1.0, a=2)])] == ["automatic"]


@pytest.mark.parametrize("name", PROBLEMS)
def test_a_choice_is_measured_by_settings_of_the_same_model(name):
    experiment = mpm.load(STUDIES / f"{name}.yaml")
    found = rivals(name, experiment)
    assert {physics(one["experiment"]) for one in found} == {physics(experiment)}
    assert {one["experiment"].grid.dimension for one in found} == {experiment.grid.dimension}
    assert min(one["error"] for one in found) < 0.003 and len({one["label"] for one in found}) == len(found) > 5


def test_physics_and_numbers_are_told_apart():
    assert physics(mpm.load(SLAB)) == "rigid"
    assert physics(mpm.load(SLAB, {"materials.unit.elastic": {"hencky": {"lam": 1.0, "mu": 1.0}}})) == "heat"
    assert numerical({"materials.unit.elastic": {}, "method.temperature": "apic"}) == {"method.temperature": "apic"}
    assert numerical({"grid.dimension": "axisymmetric"}) is None


def test_walls_of_moving_bodies_stay_on_grid_lines():
    moving = mpm.load(SLAB | {"grid": {"dimension": 1, "size": [3.0], "cell": 0.25}}, {"materials.unit.elastic": {"hencky": {"lam": 1.0, "mu": 1.0}}})
    cells = [h for h, _ in zip(grids(moving), range(20), strict=False)]
    assert all(abs(3.0 / h - round(3.0 / h)) < 1e-9 for h in cells) and cells == sorted(cells, reverse=True)


@pytest.mark.parametrize("tolerance", [0.03, 0.003, 3e-5])
def test_the_promise_is_kept_against_the_exact_solution(tolerance):
    experiment = mpm.load(SLAB)
    fronts = [row("implicit", 1e-5, 1e-3, **IMPLICIT)]
    found = choose(experiment, tolerance, fronts)
    run = mpm.run_point(mpm.load(SLAB, found.settings))
    assert run.finals["error_l2"] <= tolerance and found.predicted <= tolerance
    assert found.method == "implicit" and found.seconds > 0
    if tolerance < 1e-4:  # finer where more is asked
        assert found.settings["grid.cell"] < choose(experiment, 0.03, fronts).settings["grid.cell"]


def test_without_an_exact_solution_the_observables_are_kept():
    tree = {key: value for key, value in SLAB.items() if key != "exact"} | {"output": {"every": 0.1, "probes": {"centre": [1.5]}}}
    found = choose(mpm.load(tree), 1e-3, [row("implicit", 1e-5, 1e-3, **IMPLICIT)])
    fine = mpm.run_point(mpm.load(tree, {"grid.cell": 0.03125, "method.rigid": {"implicit": {"tolerance": 1e-8}}})).finals["temperature_centre"]
    assert mpm.run_point(mpm.load(tree, found.settings)).finals["temperature_centre"] == pytest.approx(fine, abs=1e-3)


def test_what_cannot_be_chosen_is_said():
    with pytest.raises(NoChoice, match=r"no chart of rigid reaches 0\.001 %"):
        choose(mpm.load(SLAB), 1e-5, [row("implicit", 0.1, 1.0, **IMPLICIT)])
    tree = {key: value for key, value in SLAB.items() if key != "exact"}
    with pytest.raises(NoChoice, match="observables or probes"):
        refine(mpm.load(tree), IMPLICIT, 0.01)
