"""What sets: X in closed form at constant temperature and along a ramp, in every dimension; the laws that follow it; nothing of it where no scene names it.

Each dimension and law would compile a step of its own, so compiled they are slow; all of them run in plain Python by default.
"""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from numba import config
from scipy.special import exp1

import mpm
from mpm.config import ConfigError
from mpm.materials import Condition, Constant, Sets, value
from mpm.memory import arrays
from mpm.runner import run_point
from mpm.scene.build import build
from mpm.scene.scaling import hurried
from mpm.state import NoSetting

ZANONI = {"arrhenius": {"k0": 2.8e18, "activation": "139 kJ/mol"}}
HEAT = {"fourier": {"kappa": 0, "alpha": 500}}
RATE = 2.0


def test_in_plain_python():
    """The slow tests of this file without compilation, but the one that takes half a minute so."""
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-m", "slow", "-k", "not 3-implicit", "-p", "no:cacheprovider", __file__]
    done = subprocess.run(command, env=os.environ | {"NUMBA_DISABLE_JIT": "1"}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:]


def point(loading, M=1e9, E=1e5, eta=0.0, end=1.0, step="auto", temperature=350.0):
    return mpm.load(
        {
            "grid": {"dimension": 0},
            "bodies": {"body": {"shape": "point", "temperature": temperature, "material": "dough"}},
            "materials": {"dough": {"density": 1000.0, "elastic": {"hencky": {"E": E, "nu": 0.25}}, "heat": HEAT,
                                    "flow": {"ellipse": {"M": M, "p0": 0.8, "eta": eta}}}},
            "loading": loading, "time": {"end": end, "step": step}, "output": {"every": end / 10},
        }
    )  # fmt: skip


def between(raw, baked, rate=RATE):
    return {"set": {"raw": raw, "baked": baked, "rate": rate}}


@pytest.mark.slow
def test_at_constant_temperature():
    """X = 1 - exp(-k t) whatever the step; q follows M, and at held strain E."""
    shear = [{"strain_rate": {"xx": 1.0, "yy": -1.0}}]
    run = run_point(point(shear, M=between(300.0, 900.0)))
    X = 1 - np.exp(-RATE * run.times)
    assert run.series["setting_mean"] == pytest.approx(X, abs=1e-13)
    assert run.series["kirchhoff_q"][2:] == pytest.approx((300 + 600 * X)[2:], rel=1e-12)
    held = run_point(point([{"strain_rate": {"xx": 1e-3}}], E=between(1e5, 3e5), step=0.05))
    E = (1e5 + 2e5 * X) / (1 - 2 * 0.25) / (1 + 0.25) * 0.75
    assert held.series["stress_xx"] * held.series["J_min"] == pytest.approx(E * 1e-3 * held.times, rel=1e-12)
    slow = run_point(point([{"strain_rate": {"xx": 0.01, "yy": -0.01}}], M=10.0, eta=between(1e4, 5e4), step=0.02))
    strain, mu = 0.0, 1e5 / 2.5
    for t in 0.02 * np.arange(1, 51):
        trial, chi = 3 * mu * (strain + 0.02 * 0.02 / math.sqrt(3)), 3 * mu * 0.02 / (5e4 - 4e4 * math.exp(-RATE * t))
        q = (trial + chi * 10) / (1 + chi) if trial > 10 else trial
        strain = q / (3 * mu)
    assert slow.series["kirchhoff_q"][-1] == pytest.approx(q, rel=1e-10)


@pytest.mark.slow
def test_along_a_ramp():
    """Starch in bread from 300 to 370 K at a tenth of a kelvin a second: int k dt = (k0/b) [T exp(-Ta/T) - Ta E1(Ta/T)]; of order 2 in the step."""
    Ta, k0, b = 139e3 / 8.314462618, 2.8e18, 0.1
    primitive = lambda T: T * math.exp(-Ta / T) - Ta * exp1(Ta / T)  # noqa: E731 - of exp(-Ta/T)
    errors = []
    for step in (17.5, 8.75, 4.375):
        run = run_point(point([{"temperature": 370.0}], M=between(300, 900, ZANONI), end=700.0, step=step, temperature=300.0))
        X = np.array([1 - math.exp(-k0 / b * (primitive(T) - primitive(300.0))) for T in run.series["temperature_mean"]])
        errors.append(np.max(np.abs(run.series["setting_mean"] - X)))
    assert X[7] < 0.9 < X[-1] and errors[-1] < 2e-4
    assert np.log2(errors[0] / errors[2]) / 2 > 1.9


def filled(dimension, **more):
    """A body that fills its box: it wants to expand and cannot, so its pressure is 3 K(X) alpha_L (Theta - Theta_0)."""
    D = 2 if dimension == "axisymmetric" else dimension
    shape = {"box": {"lower": [0] * D, "upper": [0.2, 0.3, 0.2][:D]}}
    if dimension == "axisymmetric":
        shape = {"cylinder": {"radius": 0.2, "height": 0.3, "base": [0, 0]}}
    sides = {1: ("left", "right"), 2: ("left", "right", "bottom", "top"), "axisymmetric": ("outer", "bottom", "top")}
    sides[3] = (*sides[2], "back", "front")
    return {
        "grid": {"dimension": dimension, "size": [0.2, 0.3, 0.2][:D], "cell": 0.1},
        "bodies": {"body": {"shape": shape, "temperature": 350.0, "material": "dough"}},
        "materials": {"dough": {"density": 1000.0, "elastic": {"hencky": {"E": between(1e4, 3e4), "nu": 0.25}}, "heat": HEAT,
                                "expansion": {"linear": {"coefficient": 1e-3, "reference": 300}},
                                "flow": {"ellipse": {"M": between(1e6, 2e6, None), "p0": {"porosity": {"initial": 0.3}}, "eta": 10}}}},
        "walls": dict.fromkeys(sides[dimension], "slip"), "time": {"end": 0.3}, "output": {"every": 0.1, "observables": ["setting.min"]},
    } | more  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("mechanics", ["explicit", "implicit"])
@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
def test_in_every_dimension(dimension, mechanics):
    run = run_point(mpm.load(filled(dimension, method={"mechanics": mechanics})))
    X = 1 - np.exp(-RATE * run.times)
    assert run.outcome.ok, run.outcome
    assert run.series["setting_mean"] == pytest.approx(X, abs=1e-13) and run.series["setting_min"] == pytest.approx(X, abs=1e-13)
    close = 1e-3 if dimension == "axisymmetric" else 1e-6  # two cells a radius: a uniform pressure is not quite in balance there, set or not
    assert run.series["pressure_mean"] == pytest.approx((1e4 + 2e4 * X) / (1 - 0.5) * 1e-3 * 50, rel=close)


@pytest.mark.slow
def test_in_the_total_frame_and_in_single_precision():
    for method in ({"frame": "total"}, {"precision": "float32"}):
        run = run_point(mpm.load(filled(2, method=method | {"mechanics": "explicit"})))
        X = 1 - np.exp(-RATE * run.times)
        assert run.series["setting_mean"] == pytest.approx(X, abs=1e-13)
        assert run.series["pressure_mean"] == pytest.approx((1e4 + 2e4 * X) / 0.5 * 0.05, rel=1e-5)


def test_between_equal_ends_it_is_that_end():
    """To the bit, whatever X; and a scene that names no setting stores none."""
    law = Sets(Constant(50.3), Constant(50.3))
    assert all(value(law, Condition(350.0, X)) == 50.3 for X in np.random.default_rng(1).random(100))
    dough = {"density": 1000.0, "elastic": {"hencky": {"E": 1e4, "nu": 0.25}}, "heat": HEAT}
    body = build(mpm.load(filled(2, output={"every": 0.1}, materials={"dough": dough}))).bodies[0]
    assert isinstance(body.setting, NoSetting) and not any("setting" in path for path in arrays(body))


@pytest.mark.slow
def test_between_equal_ends_it_changes_nothing():
    """No bit in plain Python; round-off where it is compiled: M is one number to one kernel, one a particle to the other, and each may arrange its
    divisions as it likes (mpm.lanes: reassoc, arcp, afn; without these three flags the compiled runs are the same to the bit as well)."""
    close = {"rel": 0, "abs": 0} if config.DISABLE_JIT else {"rel": 1e-12, "abs": 1e-13}
    plain = filled(2, method={"mechanics": "explicit"}, gravity=[0.0, -9.81], output={"every": 0.1})
    plain["materials"]["dough"] |= {"elastic": {"hencky": {"E": {"logistic": {"low": 1e4, "high": 2e4, "at": 340, "width": 5}}, "nu": 0.25}},
                                    "flow": {"ellipse": {"M": 50, "p0": {"porosity": {"initial": 0.3}}, "eta": 10}}}  # fmt: skip
    same = filled(2, method={"mechanics": "explicit"}, gravity=[0.0, -9.81], output={"every": 0.1})
    same["materials"]["dough"] |= {"elastic": plain["materials"]["dough"]["elastic"],
                                   "flow": {"ellipse": {"M": between(50, 50), "p0": {"porosity": {"initial": 0.3}}, "eta": 10}}}  # fmt: skip
    one, two = (run_point(mpm.load(scene | {"method": {"mechanics": "explicit", "heat_step": 0.015}})) for scene in (plain, same))
    assert "setting_mean" not in one.series and "setting_mean" in two.series
    for name, values in one.series.items():
        assert values == pytest.approx(two.series[name], **close), name


def test_it_is_kept_and_sorted_with_the_particles():
    body = build(mpm.load(filled(2))).bodies[0]
    from mpm.integrate.sorting import permute

    body.setting.X[:] = np.arange(len(body.setting.X))
    order = np.random.default_rng(3).permutation(len(body.setting.X))
    permute(body, order)
    assert np.array_equal(body.setting.X, order) and {"setting.X", "setting.k"} <= set(arrays(body))


def test_time_scaling_hurries_it():
    quick = hurried(mpm.load(filled(2, method={"mechanics": "explicit"}, time={"end": 0.3, "scale": 10})))
    body = build(quick).bodies[0]
    assert body.setting.k == pytest.approx(10 * RATE)
    flow = quick.materials["dough"].flow
    assert flow.M.baked.value == 2e6 and flow.eta.value == 1.0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"heat": None, "expansion": None}, "has no heat"),
        ({"flow": {"ellipse": {"M": between(1e6, 2e6, 3.0), "p0": 1, "eta": 10}}}, "one degree of setting"),
        ({"elastic": {"hencky": {"E": 1e4, "nu": 0.2}}}, "no rate of setting"),
        ({"flow": {"ellipse": {"M": 1e6, "p0": between(1, 2), "eta": 10}}}, "unknown law of the aspect ratio 'set'"),
    ],
)
def test_refusals_have_places(change, said):
    wrong = filled(2)
    material = wrong["materials"]["dough"] | change
    wrong["materials"]["dough"] = {key: value for key, value in material.items() if value is not None}
    with pytest.raises(ConfigError, match=said):
        mpm.load(wrong)


def test_an_observable_of_it_needs_it():
    plain = filled(2)
    plain["materials"]["dough"] |= {"elastic": {"hencky": {"E": 1e4, "nu": 0.2}}, "flow": {"ellipse": {"M": 1e6, "p0": 1, "eta": 10}}}
    with pytest.raises(ConfigError, match="no material sets"):
        mpm.load(plain)
