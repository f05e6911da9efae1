"""Bodies in uniform states by implicit steps, swelling or pressed all around: closed forms, a material point, an ordinary differential equation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import mpm
from mpm.runner import run_point

E, NU, ALPHA = 2e4, 0.2, 1e-3  # Pa, -, 1/K
LAM, MU = E * NU / (1 + NU) / (1 - 2 * NU), E / 2 / (1 + NU)
GAMMA = 3 * ALPHA * (LAM + 2 * MU / 3)  # Pa/K


def body(dimension, **more):
    shape = {1: {"box": {"lower": [0], "upper": [0.1]}}, 2: {"box": {"lower": [0.07, 0.06], "upper": [0.17, 0.16]}},
             "axisymmetric": {"cylinder": {"radius": 0.1, "height": 0.1, "base": [0, 0.06]}}}[dimension]  # fmt: skip
    dough = {"density": 600, "elastic": {"hencky": {"E": E, "nu": NU}}, "heat": {"fourier": {"kappa": 1e5, "alpha": 1000}},
             "expansion": {"linear": {"coefficient": ALPHA, "reference": 300}}}  # fmt: skip
    return {
        "grid": {"dimension": dimension, "size": [0.25] * (1 if dimension == 1 else 2), "cell": 0.05},
        "bodies": {"body": {"shape": shape, "temperature": 300, "material": "dough"}}, "materials": {"dough": dough | more.pop("dough", {})},
        "method": {"mechanics": "implicit"}, "output": {"every": more["time"]["end"]},
    } | more  # fmt: skip


def uniform(theta):
    """Strain of each of two free directions, the third held."""
    return GAMMA * (theta - 300) / (2 * MU + 2 * LAM)


@pytest.mark.plain
@pytest.mark.parametrize("dimension", [2, "axisymmetric"])
def test_a_free_body_swells_at_once(dimension):
    """In one step to rest, its volume everywhere that of the closed form, to what Newton's method leaves."""
    made = body(dimension, time={"end": 1e5, "step": 1e5})
    made["bodies"]["body"]["temperature"] = 360
    run = run_point(mpm.load(made))
    right = np.exp(2 * uniform(360) if dimension == 2 else 3 * ALPHA * 60)
    assert run.outcome.ok and [run.finals["J_min"], run.finals["J_max"]] == pytest.approx([right, right], rel=1e-7)


@pytest.mark.plain
@pytest.mark.parametrize("dimension", [pytest.param(2, marks=pytest.mark.wide), "axisymmetric"])
def test_a_pressure_squeezes_alike(dimension):
    """Between mirrors, under a pressure on the surface as it is: K_n e = -p J everywhere once areas are their own."""
    n, e = (2, -0.03) if dimension == 2 else (3, -0.03)
    p = -(2 * MU + n * LAM) * e * np.exp(-n * e)
    made = body(dimension, loads=[{"of": "body", "side": "all", "traction": {"pressure": p}}], time={"end": 1e4, "step": 1e3})
    made["bodies"]["body"]["shape"] = (
        {"box": {"lower": [0, 0], "upper": [0.1, 0.1]}} if dimension == 2 else {"cylinder": {"radius": 0.1, "height": 0.1, "base": [0, 0]}}
    )
    run = run_point(mpm.load(made))
    assert run.outcome.ok and run.facts["failed"] == 0
    assert [run.finals["J_min"], run.finals["J_max"]] == pytest.approx([np.exp(n * e)] * 2, rel=2e-5)


@pytest.mark.plain
def test_a_tin_that_is_warmed_is_a_material_point():
    """Held across, free above, and it flows: a flux warms it by 60 K in 400 s, its height is that of a point under no stress along one direction."""
    flow = {"flow": {"ellipse": {"M": 60, "p0": 0.8, "eta": 2e5}}}
    point = body(1, dough=flow, time={"end": 400, "step": 0.1})
    point["materials"]["dough"]["heat"]["fourier"]["kappa"] = 0
    point |= {"grid": {"dimension": 0}, "bodies": {"body": {"shape": "point", "temperature": 300, "material": "dough"}}, "method": {},
              "loading": [{"temperature": 360, "stress": {"xx": 0}}]}  # fmt: skip
    right = run_point(mpm.load(point)).finals["J_min"]
    assert right > 1.01 * np.exp(GAMMA * 60 / (LAM + 2 * MU))  # it flows
    heated = {"surfaces": [{"of": "body", "side": "right", "flux": {"q": 600 * 1000 * 0.1 * 60 / 400}}], "walls": {"left": "slip"}}
    run = run_point(mpm.load(body(1, dough=flow, time={"end": 400, "step": 20}, **heated)))
    assert run.outcome.ok and run.facts["failed"] == 0
    assert run.finals["volume_total"] / 0.1 == pytest.approx(right, abs=1e-5 * (right - 1))


@pytest.mark.plain
def test_a_body_that_cools_by_the_surface_that_it_grows():
    """m alpha dTheta/dt = -beta P (Theta - Theta_out) with a perimeter P that follows Theta: temperature and volume of order 2."""
    beta, end = 300.0, 200.0
    pace = lambda _, theta: -beta * 0.4 * np.exp(uniform(theta)) * (theta - 400) / (600 * 0.01 * 1000)  # noqa: E731
    theta, errors = solve_ivp(pace, (0, end), [300.0], rtol=1e-10, atol=1e-8).y[0, -1], []
    for step in (50.0, 25.0):
        air = [{"of": "body", "side": "all", "convection": {"beta": beta, "outside": 400}}]
        run = run_point(mpm.load(body(2, surfaces=air, time={"end": end, "step": step})))
        assert run.outcome.ok and abs(run.finals["heat_ledger"]) < 1e-12 * run.finals["heat_total"]
        assert run.finals["J_max"] == pytest.approx(np.exp(2 * uniform(run.finals["temperature_mean"])), rel=1e-5)
        errors.append(abs(run.finals["temperature_mean"] - theta) / (theta - 300))
    assert errors[1] < 1e-3 and np.log2(errors[0] / errors[1]) > 1.7, errors
