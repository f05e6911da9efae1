"""Elastic heating as a term of the heat equation on the grid: what it keeps, and where it is wrong against the adiabat (docs/physics.md 4, step 7)."""

import math

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.state import GridHeating, Heating

pytestmark = pytest.mark.plain

GAMMA, ALPHA, THETA = 9e-8, 1.5e-7, 2.0
EXPONENT = GAMMA / (2.0 * ALPHA)


def squeeze(core, form, step=None, M=1e3):
    """A box that fills its domain, pressed uniformly by its own motion: v = -x, so J falls alike everywhere until forces stop it; scene and run."""
    data = core.config(
        1, grid={"dimension": 1, "size": [1.0], "cell": 0.125}, surfaces=[],
        bodies={"body": {"shape": {"box": {"lower": [0.0], "upper": [0.75]}}, "temperature": THETA, "material": "solid"}},
        time={"end": 0.1, "step": step or "auto"},
    )  # fmt: skip
    solid = data["materials"]["solid"]
    solid["elastic"] = {"hencky": {"lam": 3e-5, "mu": 2e-5}}  # so soft that the motion goes on as it began
    solid["flow"] = {"ellipse": {"M": M, "p0": 0.5, "eta": 0.0}}
    solid["heat"] = {"fourier": {"kappa": 0.0, "alpha": ALPHA}}
    solid["expansion"] = {"modulus": {"gamma": GAMMA, "reference": THETA}}
    solid["heating"] = {"elastic": {"form": form}}

    def press(scene):
        p = scene.bodies[0].particles
        p.v[:, 0], p.C[:, 0, 0] = -p.x[:, 0], -1.0

    return core.play(mpm.load(data), press)


def inside(scene):
    """Temperatures and volumes of the particles that the free end does not reach."""
    body = scene.bodies[0]
    kept = body.particles.x[:, 0] < 0.2
    return body.thermal.zero + body.thermal.theta[kept], body.particles.J[kept]


def test_adiabat_is_exact_and_the_grid_form_is_of_first_order(core):
    """Theta J^Gamma = Theta_0 whatever the step; on the grid the error halves with the step."""
    theta, J = inside(squeeze(core, "adiabat", 0.02)[0])
    assert theta * J**EXPONENT == pytest.approx(THETA, rel=1e-12) and J.max() < 0.93
    errors = []
    for step in (0.02, 0.01, 0.005):
        theta, J = inside(squeeze(core, "grid", step)[0])
        errors.append(np.abs(theta * J**EXPONENT / THETA - 1).max())
    assert 0.9 < core.order(errors) < 1.1 and errors[0] > 1e-4


def test_flow_of_volume_deceives_the_grid_form(core):
    """Past yield under pressure the elastic volume stays, so the adiabat stops heating; the grid form heats on with the total volume."""
    right, wrong = (inside(squeeze(core, form, M=1e-7)[0]) for form in ("adiabat", "grid"))
    assert right[0].max() / THETA - 1 < 0.01
    assert np.log(wrong[0] / THETA) == pytest.approx(-EXPONENT * np.log(wrong[1]), rel=0.05) and (wrong[0] / THETA - 1).min() > 0.02


def test_what_is_taken_up_is_kept(core):
    """The heat ledger closes to round-off."""
    scene, run = squeeze(core, "grid")
    assert isinstance(scene.bodies[0].heating, GridHeating)
    assert abs(run.finals["heat_ledger"]) < 1e-12 * run.finals["heat_total"] and run.finals["heat_total"] > 0


def test_the_adiabat_is_the_default(core):
    from mpm.scene.build import build

    assert isinstance(build(core.experiment(1)).bodies[0].heating, Heating)


def test_a_point_has_no_grid():
    with pytest.raises(ConfigError, match="has no grid"):
        mpm.load({"grid": {"dimension": 0}, "bodies": {"b": {"shape": "point", "material": "m"}}, "loading": [{"strain_rate": {"xx": 1}}], "time": {"end": 1},
                  "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0}}, "heat": {"fourier": {"kappa": 0, "alpha": 1}},
                                      "expansion": {"modulus": {"gamma": 1}}, "heating": {"elastic": {"form": "grid"}}}}})  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
def test_uniform_squeeze_in_every_dimension(core, dimension):
    """div v with its hoop part: Theta of a body that shrinks alike in every direction, to the first order of the step."""
    data = core.config(dimension, surfaces=[], time={"end": 0.05, "step": 0.0025})
    solid = data["materials"]["solid"]
    solid["elastic"], solid["heat"]["fourier"]["kappa"] = {"hencky": {"lam": 3e-6, "mu": 2e-6}}, 0.0
    solid["expansion"], solid["heating"] = {"modulus": {"gamma": 1e-3, "reference": core.HOT}}, {"elastic": {"form": "grid"}}

    def press(scene):
        p, D = scene.bodies[0].particles, core.DIRECTIONS[dimension]
        p.v[:], p.C[:] = -(p.x - ([0.0, 1.0] if dimension == "axisymmetric" else 1.0)), -np.eye(D)

    scene, run = core.play(mpm.load(data), press)
    body = scene.bodies[0]
    warmed = np.log1p((body.thermal.theta + body.thermal.zero) / core.HOT - 1) / (-1e-3 / 3.0 * np.log(body.particles.J))
    assert run.outcome.ok and np.median(warmed) == pytest.approx(1.0, rel=5e-3) and math.isfinite(warmed.sum())
