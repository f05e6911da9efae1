"""Exact problems of the material point, against numbers that were not made here and against the solutions that configs name."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.runner import run_point, run_points
from mpm.verification import exact_solution, relaxation, rheometer

ROOT = Path(__file__).parents[2]
PROBLEMS = ("adiabatic", "thermal_expansion", "relaxation", "shear_heating", "lumped_cooling")


def rows(name):
    with open(ROOT / "tests" / "reference" / name, newline="") as file:
        return [{key: value if key == "model" else float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def problem(name, **changes):
    return mpm.load(ROOT / "configs" / "verification" / f"{name}.yaml", changes)


def order(errors):
    return -np.polyfit(np.arange(len(errors)) * math.log(2), np.log(errors), 1)[0]


@pytest.mark.plain
@pytest.mark.parametrize("step", [1.0, 0.01])
def test_adiabat_in_any_step(step):
    table = rows("adiabatic.csv")
    many = [problem("adiabatic", **{"gamma": row["Gamma=c*lambda/(R0*alpha)"], "loading.0.stretch_rate.zz": row["J"] - 1, "time.step": step}) for row in table]
    for row, run in zip(table, run_points(many), strict=True):
        assert run.finals["temperature_mean"] / 300 == pytest.approx(row["theta/theta0"], rel=1e-12)
        assert run.finals["J_min"] == pytest.approx(row["J"], rel=1e-14)


@pytest.mark.plain
def test_thermal_expansion_table():
    for row in rows("thermal_expansion.csv"):
        changes = {"lam": row["lambda"], "materials.solid.elastic.hencky.mu": row["mu"], "gamma": row["c_lambda"], "loading.0.temperature": 300 + row["dTheta"]}
        stresses = [{"xx": 0, "yy": 0, "zz": 0}, {}, {"xx": 0, "yy": 0}, {"xx": 0}]
        free, clamped, plane, line = run_points([problem("thermal_expansion", **changes, **{"loading.0.stress": stress}) for stress in stresses])
        stretch = lambda run: math.exp(run.finals["strain_xx"])  # noqa: E731
        tau = lambda run, axis: run.finals[f"stress_{axis}"] * run.finals["J_min"]  # noqa: E731
        assert stretch(free) == pytest.approx(row["free3D_stretch"], rel=1e-12)
        assert free.finals["J_min"] == pytest.approx(row["free3D_J"], rel=1e-12)
        assert [tau(clamped, axis) for axis in ("xx", "yy", "zz")] == pytest.approx([row["constrained_tau_iso"]] * 3, rel=1e-12)
        assert stretch(plane) == pytest.approx(row["planestrain_inplane_stretch"], rel=1e-12)
        assert tau(plane, "zz") == pytest.approx(row["planestrain_tau33"], rel=1e-12)
        assert stretch(line) == pytest.approx(row["uniaxial_stretch"], rel=1e-12)
        assert tau(line, "zz") == pytest.approx(row["uniaxial_tau_lateral"], rel=1e-12)


@pytest.mark.plain
@pytest.mark.parametrize("model", ["E1", "E2"])
def test_relaxation_table_at_order_one(model):
    table = [row for row in rows("relaxation.csv") if row["model"] == model]
    starts = sorted({(row["p0"], row["p_init/M"], row["q_init/M"]) for row in table})
    worst = []
    for step in (0.005, 0.0025, 0.00125):
        many = []
        for p0, p, q in starts:  # K = M = eta = 1, so times are t K/eta
            strain = {"xx": -p / 3 + 2 * q, "yy": -p / 3 - q, "zz": -p / 3 - q}
            shape = {"point": {"strain": strain}}
            changes = {"bodies.body.shape": shape, "materials.solid.elastic.hencky": {"K": 1, "mu": 1 / 6}, "flow.ellipse": {"M": 1, "p0": p0, "eta": 1}}
            changes = {key if "." not in key or key.startswith(("bodies", "materials")) else f"materials.solid.{key}": value for key, value in changes.items()}
            changes |= {"map": "clipped" if model == "E1" else "radial", "time": {"end": 5, "step": step}, "output.every": 0.05}
            many.append(problem("relaxation", **changes))
        error = 0.0
        for (p0, p, q), run in zip(starts, run_points(many), strict=True):
            assert run.series["kirchhoff_q"][0] == pytest.approx(q, rel=1e-14)
            for row in table:
                if (row["p0"], row["p_init/M"], row["q_init/M"]) == (p0, p, q):
                    at = np.argmin(np.abs(run.times - row["t*K/eta"]))
                    error = max(error, abs(run.series["kirchhoff_p"][at] - row["p/M"]), abs(run.series["kirchhoff_q"][at] - row["q/M"]))
        worst.append(error)
    assert order(worst) > relaxation.ORDER - 0.1
    assert worst[-1] < 0.005


def test_relaxation_solution_is_the_table():
    """The exact solution that configs name, against the independent numbers."""
    for model in ("E1", "E2"):
        for row in [row for row in rows("relaxation.csv") if row["model"] == model and row["t*K/eta"] == 2]:
            p, q = row["p_init/M"], row["q_init/M"]
            strain = {"xx": -p / 3 + 2 * q, "yy": -p / 3 - q, "zz": -p / 3 - q}
            found = exact_solution(
                problem(
                    "relaxation",
                    **{
                        "bodies.body.shape": {"point": {"strain": strain}},
                        "materials.solid.elastic.hencky": {"K": 1, "mu": 1 / 6},
                        "materials.solid.flow.ellipse": {"M": 1, "p0": row["p0"], "eta": 1, "map": "clipped" if model == "E1" else "radial"},
                    },
                )
            )(np.array([0.0, 2.0]))
            assert found["kirchhoff_p"][1] == pytest.approx(row["p/M"], rel=1e-10)
            assert found["kirchhoff_q"][1] == pytest.approx(row["q/M"], rel=1e-10)


@pytest.mark.plain
@pytest.mark.parametrize("name", PROBLEMS)
def test_configs_report_their_error(name):
    experiment = problem(name)
    runs = run_points([case.experiment for case in mpm.plan(experiment).cases])
    assert all(run.outcome.ok for run in runs)
    most = 0.1 if name == "relaxation" else 1e-12
    assert max(run.series["error_relative"].max() for run in runs) < most
    if name in ("adiabatic", "shear_heating", "lumped_cooling"):
        assert max(run.finals["error_max"] for run in runs) < 1e-9


@pytest.mark.plain
def test_shear_heating_by_hand():
    run = run_point(problem("shear_heating"))
    equivalent = math.sqrt(2 / 3 * (0.4**2 + 0.1**2 + 0.3**2))
    assert run.finals["temperature_mean"] - 300 == pytest.approx(2e4 * (equivalent - 2e4 / (3 * 1e6 / 2.6)) / 1e5, rel=1e-9)


@pytest.mark.plain
@pytest.mark.parametrize("step", [1e-4, 1e-3, 0.1])
def test_shear_heating_keeps_its_books(step):
    """Heat taken up, and dissipation turned to heat: the same to 1e-12, however many steps of a rise of 0.08 K on 300 K."""
    run = run_point(problem("shear_heating", **{"time.step": step}))
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * run.finals["heat_total"]
    assert run.finals["heat_total"] == pytest.approx(run.finals["dissipation_total"], rel=1e-12)


@pytest.mark.plain
def test_lumped_time_to_a_temperature():
    run = run_point(problem("lumped_cooling", **{"time.step": 0.1}))
    assert run.finals["time_to_cube_60_degC"] == pytest.approx(math.log(2) * 8500 * 380 / (20 * 1200), rel=1e-6)
    assert np.array_equal(run.series["temperature_cube"], run.series["temperature_mean"])


@pytest.mark.plain
def test_lumped_body_with_latent_heat_is_of_order_two_and_keeps_its_heat():
    from scipy.integrate import solve_ivp

    alpha = {"bump": {"base": 380, "heat": 2e4, "at": "60 degC", "width": 5}}
    law = lambda theta: 380 + 2e4 / (5 * math.sqrt(2 * math.pi)) * np.exp(-0.5 * ((theta - 333.15) / 5) ** 2)  # noqa: E731
    right = solve_ivp(lambda _, y: -20 * 1200 / (8500 * law(y)) * (y - 293.15), (0, 300), [373.15], rtol=1e-11, atol=1e-9).y[0, -1]
    errors = []
    for step in (10, 5, 2.5):
        made = problem("lumped_cooling", **{"alpha": alpha, "time.step": step})
        run = run_point(mpm.load({**made.resolved(), "exact": None}))
        errors.append(abs(run.finals["temperature_mean"] - right))
        assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
    assert order(errors) > 1.8


@pytest.mark.plain
def test_a_scene_that_is_not_the_problem_is_refused():
    with pytest.raises(ValueError, match="add up to zero"):
        run_point(problem("shear_heating", **{"loading.0.strain_rate.xx": 0.5}))
    with pytest.raises(ValueError, match="every strain"):
        run_point(problem("adiabatic", **{"loading": [{"stress": {"xx": 0}}]}))


def test_rheometer_reads_its_parameters_back():
    made = mpm.load(ROOT / "configs" / "scenes" / "dough_rheometer.yaml")
    cases = mpm.plan(made).cases
    for case, run in zip(cases, run_points([case.experiment for case in cases]), strict=True):
        flow = case.experiment.materials["dough"].flow
        found = rheometer.read_run(run, hold=8.0)
        assert found.E == pytest.approx(12e3, rel=1e-9) and found.nu == pytest.approx(0.15, rel=1e-9)
        assert found.M == pytest.approx(flow.M.value, rel=0.02)
        assert found.p0 == pytest.approx(flow.p0.value, rel=0.02)
        assert found.eta == pytest.approx(flow.eta.value, rel=0.02)


@pytest.mark.plain
def test_rheometer_without_viscosity():
    run = run_point(mpm.load(ROOT / "configs" / "scenes" / "dough_rheometer.yaml", {"p0": 0.6, "eta": 0}))
    found = rheometer.read_run(run, hold=8.0)
    assert (found.M, found.p0, found.eta) == (pytest.approx(300, rel=1e-9), pytest.approx(0.6, rel=1e-9), 0.0)
