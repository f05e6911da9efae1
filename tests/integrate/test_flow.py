"""Viscoplastic flow of bodies, step by step that of the material point: every dimension, the strains out of the plane, dissipation and both heatings.

Without the compiler a case takes a second, in 3-D five.
"""

import numpy as np
import pytest

import mpm
from mpm.diagnostics import strains
from mpm.scene.point import run_zero

pytestmark = pytest.mark.plain

STEP, STEPS, UNIT = 0.05, 5, 1e-14  # UNIT: moduli so small that no force changes the motion
RATES = {1: (-0.4,), 2: (-0.7, 0.3), "axisymmetric": (0.3, -0.4), 3: (0.5, -0.3, 0.2)}  # v = rate X, along axes that are turned in two and three directions
CASES = [(dimension, form) for dimension in RATES for form in ("radial", "clipped")]
CASES = [pytest.param(*case, marks=pytest.mark.slow if case[0] == 3 else []) for case in CASES]


def material(form):
    return {
        "density": 2.0,
        "elastic": {"hencky": {"lam": 3 * UNIT, "mu": 2 * UNIT}},
        "flow": {"ellipse": {"M": 0.2 * UNIT, "p0": 0.8, "eta": 0.15 * UNIT, "map": form}},
        "heat": {"fourier": {"kappa": 0.0, "alpha": 1e-3 * UNIT}},
        "expansion": {"modulus": {"gamma": 5e-4 * UNIT, "reference": 400.0}},
        "heating": {"elastic": {}, "dissipation": {"fraction": 0.7}},
    }


def turned(dimension, rates):
    """Velocity gradient at the start."""
    if dimension == "axisymmetric" or len(rates) == 1:
        return np.diag(rates)
    Q = np.linalg.qr(np.random.default_rng(3).standard_normal((len(rates), len(rates))))[0]
    return Q @ np.diag(rates) @ Q.T


def stepped(core, dimension, form):
    """(body after its last step, dissipation): a step at a time, each from the velocities of the uniform motion, which APIC's slopes follow a step late."""
    D, pull = core.DIRECTIONS[dimension], turned(dimension, RATES[dimension])
    data = core.config(dimension, surfaces=[], materials={"solid": material(form)}, time={"end": STEP, "step": STEP}, output={"every": STEP})
    experiment, body, lost = mpm.load(data), None, 0.0
    for k in range(STEPS):

        def throw(scene, body=body, k=k):
            p = scene.bodies[0].particles
            if body is not None:
                for name in ("x", "B", "J"):
                    getattr(p, name)[:] = getattr(body.particles, name)
                scene.bodies[0].thermal.theta[:] = body.thermal.theta
            rates = pull @ np.linalg.inv(np.eye(D) + k * STEP * pull)
            p.v[:], p.C[:] = (p.x - (0.0 if dimension == "axisymmetric" else 1.0)) @ rates.T, rates

        scene, run = core.play(experiment, throw)
        assert run.outcome.ok and run.steps == 1
        body, lost = scene.bodies[0], lost + run.finals["dissipation_total"]
    return scene.space, body, lost


def at_a_point(core, dimension, form):
    """The same by mpm.point: its finals, and the axes along which nothing moves."""
    rates = RATES[dimension]
    third = dict(zip(("xx", "yy", "zz"), (*rates, rates[0]) if dimension == "axisymmetric" else rates, strict=False))
    data = {"grid": {"dimension": 0}, "bodies": {"body": {"shape": "point", "temperature": 400.0, "material": "solid"}}, "loading": [{"stretch_rate": third}],
            "materials": {"solid": material(form)}, "time": {"end": STEPS * STEP, "step": STEP}, "output": {"every": STEPS * STEP}}  # fmt: skip
    return run_zero(mpm.load(data)).finals, [axis for axis in ("xx", "yy", "zz") if axis not in third]


@pytest.mark.parametrize(("dimension", "form"), CASES)
def test_a_body_in_uniform_motion_is_its_material_point(core, dimension, form):
    """Elastic strains, those out of the plane too, which plastic flow makes though nothing moves there; volume, temperature, dissipation."""
    space, body, lost = stepped(core, dimension, form)
    exact, still = at_a_point(core, dimension, form)
    assert all(abs(exact[f"strain_elastic_{axis}"]) > 1e-3 and exact[f"strain_{axis}"] == 0 for axis in still)
    e = np.sort([exact[f"strain_elastic_{axis}"] for axis in ("xx", "yy", "zz")])
    assert np.abs(np.sort(strains(space, body.particles.B), axis=1) - e).max() < 1e-12
    assert body.particles.J == pytest.approx(exact["J_min"], rel=1e-12)
    assert exact["temperature_mean"] > 405 and body.thermal.theta == pytest.approx(exact["temperature_mean"] - 400, rel=1e-10)
    assert lost / np.sum(body.particles.V0) == pytest.approx(exact["dissipation_total"], rel=1e-10) and lost > 0
