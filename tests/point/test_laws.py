"""Every parameter of a material by every kind of law, in closed form: E, M, p0 and eta along a prescribed temperature; p0 by porosity.

Each kind compiles a point of its own, so compiled they are slow; all of them run in plain Python by default, and one batch of everything compiled.
"""

import math
import os
import subprocess
import sys

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.scene.point import batch, run_zero

HEAT = {"heat": {"fourier": {"kappa": 0, "alpha": 500}}}
MU, K = 1.0e5, 2.0e5 + 2.0e5 / 3.0
WARM = {"temperature": 400}


def laws(low, high):
    """The four kinds between two values, and each as a plain function of temperature."""
    tall = 4 * (high - low)
    return {
        "constant": (high, lambda t: high),
        "table": ({"table": {"temperature": [310, 350, 390], "value": [low, high, low]}}, lambda t: np.interp(t, [310, 350, 390], [low, high, low])),
        "logistic": ({"logistic": {"low": low, "high": high, "at": 350, "width": 8}}, lambda t: low + (high - low) / (1 + math.exp(-(t - 350) / 8))),
        "bump": (
            {"bump": {"base": low, "heat": tall, "at": 350, "width": 4}},
            lambda t: low + tall / (4 * math.sqrt(2 * math.pi)) * math.exp(-((t - 350) ** 2) / 32),
        ),
    }


def test_in_plain_python():
    """The slow tests of this file without compilation."""
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-m", "slow", "-p", "no:cacheprovider", __file__]
    done = subprocess.run(command, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:]


kinds = pytest.mark.parametrize("kind", ["constant", "table", "logistic", "bump"])


def kirchhoff(run, axis):
    return run.series[f"stress_{axis}"] * run.series["J_min"]


@pytest.mark.slow
@kinds
def test_young_modulus(point, kind):
    """Uniaxial stress tau = E(Theta) eps at any temperature, moduli of one Poisson ratio."""
    law, E = laws(1e4, 5e4)[kind]
    solid = HEAT | {"elastic": {"hencky": {"E": law, "nu": 0.3}}}
    run = run_zero(point([{"strain_rate": {"zz": 0.02}, "stress": {"xx": 0, "yy": 0}} | WARM], material=solid, every=0.05))
    young = np.array([E(t) for t in run.series["temperature_mean"]])
    assert kirchhoff(run, "zz") == pytest.approx(young * run.series["strain_zz"], rel=1e-12, abs=1e-12)
    assert run.series["strain_xx"] == pytest.approx(-0.3 * run.series["strain_zz"], rel=1e-11, abs=1e-15)
    assert run.series["energy_elastic"] == pytest.approx(0.5 * young * run.series["strain_zz"] ** 2, rel=1e-11, abs=1e-12)


@pytest.mark.slow
@kinds
@pytest.mark.parametrize("strength", ["coefficient", "gamma", "c"])
def test_young_modulus_under_thermal_stress(point, kind, strength):
    """Clamped: tau = -3 K(Theta) alpha_L (Theta - Theta_0): a coefficient follows the moduli, gamma does not. Latched too."""
    law, E = laws(1e4, 5e4)[kind]
    nu, value = 0.3, {"coefficient": 1e-3, "gamma": 13.0, "c": 2e-3}[strength]
    name = {"coefficient": "linear", "gamma": "modulus", "c": "source"}[strength]
    for expansion, top in (({name: {strength: value, "reference": 300}}, 1e9), ({"latched": {strength: value, "reference": 300, "set": 360}}, 360.0)):
        run = run_zero(point([WARM], material=HEAT | {"elastic": {"hencky": {"E": law, "nu": nu}}, "expansion": expansion}, every=0.05))
        for t, tau in zip(run.series["temperature_mean"], kirchhoff(run, "xx"), strict=True):
            gamma = {"coefficient": E(t) / (1 - 2 * nu) * value, "gamma": value, "c": E(t) * nu / ((1 + nu) * (1 - 2 * nu)) * value}[strength]
            assert tau == pytest.approx(-gamma * (min(t, top) - 300), rel=1e-12, abs=1e-9)


@pytest.mark.slow
@kinds
def test_yield_stress(point, kind):
    """Rate-independent shear: q = M(Theta)."""
    law, M = laws(300.0, 900.0)[kind]
    run = run_zero(point([{"strain_rate": {"xx": 0.5, "yy": -0.5}} | WARM], flow={"M": law}, material=HEAT, every=0.02))
    assert run.series["kirchhoff_q"][2:] == pytest.approx([M(t) for t in run.series["temperature_mean"][2:]], rel=1e-12)


@pytest.mark.slow
@kinds
def test_aspect(point, kind):
    """Rate-independent compaction: p = p0(Theta) M."""
    law, p0 = laws(0.5, 1.5)[kind]
    run = run_zero(point([{"strain_rate": {"xx": -0.2, "yy": -0.2, "zz": -0.2}} | WARM], flow={"p0": law}, material=HEAT, every=0.02))
    assert run.series["kirchhoff_p"][2:] == pytest.approx([1000 * p0(t) for t in run.series["temperature_mean"][2:]], rel=1e-12)


@pytest.mark.slow
@kinds
@pytest.mark.parametrize("E", [2.6e5, {"logistic": {"low": 2e5, "high": 3e5, "at": 350, "width": 8}}], ids=["E", "E(T)"])
def test_viscosity(point, kind, E):
    """Shear at a steady rate g: one implicit step of q' = 3 mu (g - (q - M)/eta) at the viscosity and the modulus of its end, whatever its length."""
    law, eta = laws(1e4, 5e4)[kind]
    solid, g, dt = HEAT | {"elastic": {"hencky": {"E": E, "nu": 0.3}}}, 0.01 * 2 / math.sqrt(3), 0.02
    shear = [{"strain_rate": {"xx": 0.01, "yy": -0.01}} | WARM]
    run = run_zero(point(shear, flow={"eta": law, "M": 10}, material=solid, every=dt, time={"end": 1.0, "step": dt}))
    strain, q = 0.0, 0.0
    for t, found in zip(run.series["temperature_mean"][1:], run.series["kirchhoff_q"][1:], strict=True):
        mu = (2.6e5 if E == 2.6e5 else 2e5 + 1e5 / (1 + math.exp(-(t - 350) / 8))) / 2.6
        trial, chi = 3 * mu * (strain + g * dt), 3 * mu * dt / eta(t)
        q = (trial + chi * 10) / (1 + chi) if trial > 10 else trial
        strain = q / (3 * mu)
        assert found == pytest.approx(q, rel=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1.0, 2.0])
@pytest.mark.parametrize("form", ["radial", "clipped"])
def test_aspect_by_porosity(point, form, exponent):
    """Pressed or swelling, p = p0(phi) M with 1 - phi = (1 - phi_0)/J and p0 by the plastic Poisson ratio 1/2 (1 - phi)^n."""
    for rate in (-0.25, 0.25):
        run = run_zero(point([{"strain_rate": {"xx": rate, "yy": rate, "zz": rate}}],
                             flow={"p0": {"porosity": {"initial": 0.6, "exponent": exponent}}, "map": form}, every=0.01))  # fmt: skip
        nu = 0.5 * (0.4 / run.series["J_min"][2:]) ** exponent
        assert np.abs(run.series["kirchhoff_p"][2:]) == pytest.approx(1000 * np.sqrt((1 + nu) / (0.5 - nu)) / 3, rel=1e-12)


@pytest.mark.slow
def test_plastic_poisson_ratio_follows_porosity(point):
    """Uniaxial stress: lateral over axial plastic strain of a step is -nu_p of its end."""
    run = run_zero(point([{"strain_rate": {"zz": -0.4}, "stress": {"xx": 0, "yy": 0}}], flow={"p0": {"porosity": {"initial": 0.5}}}, every=0.01,
                         time={"end": 1.0, "step": 0.01}))  # fmt: skip
    plastic = {axis: run.series[f"strain_{axis}"] - run.series[f"strain_elastic_{axis}"] for axis in ("xx", "zz")}
    seen = -np.diff(plastic["xx"]) / np.diff(plastic["zz"])
    assert seen[3:] == pytest.approx(0.5 * (0.5 / run.series["J_min"][4:]) ** 2, rel=1e-8)


@pytest.mark.slow
def test_closed_pores(point):
    """Pressed to the volume of its solid and past it: p0 ends at 1000, and the run does not."""
    run = run_zero(point([{"strain_rate": {"xx": -0.3, "yy": -0.3, "zz": -0.3}}], flow={"M": 10, "p0": {"porosity": {"initial": 0.3}}}, every=0.005))
    assert run.outcome.ok and run.series["J_min"][-1] < 0.7
    assert np.abs(run.series["kirchhoff_p"]).max() == pytest.approx(1e4, rel=1e-12)


@pytest.mark.plain
def test_points_of_one_batch(point):
    """Moduli, aspects and expansions of several points in one call are those of each alone."""
    logistic = {"logistic": {"low": 1e4, "high": 5e4, "at": 350, "width": 8}}
    many = []
    for nu, phi in ((0.2, 0.5), (0.3, 0.6)):
        solid = HEAT | {"elastic": {"hencky": {"E": logistic, "nu": nu}}, "expansion": {"linear": {"coefficient": 1e-3 * nu, "reference": 300}}}
        many.append(point([{"strain_rate": {"zz": -0.2}} | WARM], flow={"p0": {"porosity": {"initial": phi}}}, material=solid))
    for one, run in zip(many, batch(many), strict=True):
        alone = run_zero(one)
        assert run.outcome.ok and all(np.array_equal(run.series[name], alone.series[name]) for name in run.series)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"elastic": {"hencky": {"E": {"logistic": {"low": 0, "high": 1e4, "at": 350, "width": 8}}, "nu": 0.3}}}, "Young's modulus is out of range"),
        ({"heating": {"elastic": {}}}, "constant moduli only"),
        ({"flow": {"ellipse": {"M": {"porosity": {"initial": 0.5}}, "p0": 1, "eta": 0}}}, "unknown"),
        ({"flow": {"ellipse": {"M": 1, "p0": {"porosity": {"initial": 1.0}}, "eta": 0}}}, "porosity is out of range"),
    ],
)
def test_refusals(point, change, words):
    warm = {"elastic": {"hencky": {"E": {"table": {"temperature": [300, 400], "value": [1e4, 2e4]}}, "nu": 0.3}}}
    with pytest.raises(ConfigError, match=words):
        point([WARM], material=HEAT | {"expansion": {"linear": {"coefficient": 1e-3}}} | warm | change)


def test_exact_solutions_want_a_constant_modulus(point):
    solid = HEAT | {"elastic": {"hencky": {"E": {"table": {"temperature": [300, 400], "value": [1e4, 2e4]}}, "nu": 0.3}}}
    with pytest.raises(ValueError, match="constant E, not the table of solid"):
        mpm.run_point(point([WARM], material=solid | {"expansion": {"linear": {"coefficient": 1e-3}}}, exact={"thermal_expansion": {}}))
