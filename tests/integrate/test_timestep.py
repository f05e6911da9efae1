"""Every limit of the step, by formula, and that a run reports the one that binds."""

import math

import numpy as np
import pytest

from mpm.integrate.strain import RATE, REPORT, SPEED, STRAIN
from mpm.integrate.timestep import DRAG, limits
from mpm.scene.build import build

H, RHO, ALPHA, LAM, MU = 0.25, 2.0, 1.5, 3.0, 2.0


def now(core, dimension, changes=None, **report):
    scene = build(core.experiment(dimension, changes))
    reports = np.zeros((1, REPORT))
    for name, value in report.items():
        reports[0, {"speed": SPEED, "rate": RATE, "strain": STRAIN}[name]] = value
    return limits(scene.space, core.DIRECTIONS[dimension], scene.bodies, reports)


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
def test_elastic_wave(core, dimension):
    D = core.DIRECTIONS[dimension]
    expected = 0.5 * H * math.sqrt(RHO / (D * LAM + 2 * MU))
    found = now(core, dimension)
    assert found.mechanical == {"elastic wave": pytest.approx(expected, rel=1e-14)} and found.step() == found.mechanical["elastic wave"]
    stiffened = now(core, dimension, strain=-0.3).step()
    assert stiffened == pytest.approx(expected / math.sqrt(1.3), rel=1e-14)


def test_elastic_heating_stiffens_the_wave(core):
    gamma = 0.2
    coupling = gamma**2 * core.HOT / (RHO * ALPHA * (LAM + 2 * MU))
    found = now(core, 1, {"materials.solid.expansion.modulus.gamma": gamma})
    assert found.step() == pytest.approx(now(core, 1).step() / math.sqrt(1 + coupling), rel=1e-14)


def test_drag_and_its_absence(core):
    """Half the time in which a drag stops a body; a traction alone sets no such limit."""
    pull = {"of": "body", "side": "right", "traction": {"nominal": [0.2]}}
    for loads, limit in (([pull], {}), ([pull, {"of": "body", "drag": {"rate": 8.0}}], {"drag": pytest.approx(DRAG / 8.0)})):
        scene = build(core.experiment(1, loads=loads))
        found = limits(scene.space, 1, scene.bodies, np.zeros((1, REPORT))).mechanical
        assert {name: value for name, value in found.items() if name == "drag"} == limit


def test_advection_and_velocity_gradient(core):
    found = now(core, 1, speed=100.0, rate=8.0)
    assert found.mechanical["advection"] == pytest.approx(0.5 * H / 10.0) and found.mechanical["velocity gradient"] == pytest.approx(0.25 / 8.0)
    assert found.step() == found.mechanical["advection"]


def test_heat(core):
    found = now(core, 1, {"kappa": 0.2, "beta": 3.0})
    conduction, exchange = 0.4 * RHO * ALPHA * H * H / 0.2, RHO * ALPHA * H / (2 * 3.0)
    # beta acts in series with a penalty of 1000 kappa/h, so that it may be infinite: 0.4 % here.
    assert found.heat == {"conduction": pytest.approx(conduction), "surface exchange": pytest.approx(exchange, rel=5e-3)}
    assert found.substep() == pytest.approx(1 / sum(1 / limit for limit in found.heat.values()))
    assert found.pace == pytest.approx(0.15 * RHO * ALPHA * H * H / 0.2)


def test_no_conduction_no_limit(core):
    scene = build(core.experiment(1, {"kappa": 0.0}, drop=("surfaces",)))
    found = limits(scene.space, 1, scene.bodies, np.zeros((1, REPORT)))
    assert found.heat == {} and found.pace == found.substep() == math.inf


def test_latent_heat_does_not_shorten_the_step(core):
    """The smallest alpha between the coldest and the warmest particle counts."""
    bump = {"bump": {"base": ALPHA, "heat": 500.0, "at": core.HOT, "width": 1.0}}
    scene = build(core.experiment(1, {"alpha": bump}))
    scene.bodies[0].thermal.theta[0] -= 50.0
    assert limits(scene.space, 1, scene.bodies, np.zeros((1, REPORT))).heat["conduction"] == pytest.approx(0.4 * RHO * ALPHA * H * H / 0.1, rel=1e-6)


SOFT = {"materials.solid.elastic.hencky.lam": 1e-6, "materials.solid.elastic.hencky.mu": 1e-6}
SLOW_HEAT = {"kappa": 1e-4, "beta": 1e-4}
BINDING = {
    "elastic wave": ({}, SLOW_HEAT, {}),
    "advection": ({"velocity": [0.5]}, SOFT | SLOW_HEAT | {"output.every": 0.5}, {}),
    "heat pace or output": ({}, {"kappa": 1.0}, {}),
    "conduction (heat sub-steps)": ({}, {"kappa": 1.0, "beta": 1e-4}, {"heat_step": 0.25, "heat": {"explicit": {}}}),
    "surface exchange (heat sub-steps)": ({}, {"kappa": 0.01, "beta": 10.0}, {"heat_step": 0.25, "heat": {"explicit": {}}}),
    "time.step": ({}, SLOW_HEAT | {"time.step": 0.01}, {}),
}


@pytest.mark.parametrize("name", BINDING)
def test_the_binding_limit_is_reported(core, name):
    motion, changes, method = BINDING[name]
    body = core.config(1)["bodies"]["body"] | motion
    run = core.play(core.experiment(1, changes, bodies={"body": body}, method=method))[1]
    assert run.outcome.ok
    heat, mechanical = ({k: v for k, v in run.facts["bound_steps"].items() if ("sub-steps" in k) == kind} for kind in (True, False))
    counted = heat if "sub-steps" in name else mechanical
    assert max(counted, key=counted.get) == name
    if "sub-steps" not in name:
        assert sum(mechanical.values()) == run.steps


def test_velocity_gradient_binds(core):
    def prepare(scene):
        p = scene.bodies[0].particles
        p.v[:, 0], p.C[:] = -4.0 * (p.x[:, 0] - p.x[:, 0].mean()), -4.0

    run = core.play(core.experiment(1, SOFT | SLOW_HEAT | {"time.end": 0.1, "output.every": 0.1}), prepare)[1]
    assert run.outcome.ok and max(run.facts["bound_steps"], key=run.facts["bound_steps"].get) == "velocity gradient"


def test_a_squeezed_body_stays_stable(core):
    """A squeezed body is stiffer: the energy stays within the 5 % by which symplectic Euler may show it too large."""

    def squeeze(scene):
        p = scene.bodies[0].particles
        p.v[:, 0], p.C[:] = -1.0 * (p.x[:, 0] - p.x[:, 0].mean()), -1.0

    run = core.play(core.experiment(1, SLOW_HEAT | {"time.end": 5.0, "output.every": 0.25}), squeeze)[1]
    assert run.outcome.ok
    energy = run.series["energy_kinetic"] + run.series["energy_elastic"]
    assert energy.max() < 1.05 * energy[0]


def test_radiation_limits_the_step_by_its_slope(core):
    """d(sigma e T^4)/dT = 4 sigma e T^3 at the hottest of body and sky, beside beta."""
    hottest = max(core.HOT, 350.0)
    slope = 4 * 5.670374419e-8 * 0.9 * hottest**3
    sky = [{"of": "body", "side": "left", "radiation": {"emissivity": 0.9, "surroundings": 350.0}}]
    air = [{"of": "body", "side": "left", "convection": {"beta": slope, "outside": 350.0}}]
    both = [limits(scene.space, 1, scene.bodies, np.zeros((1, REPORT))).heat["surface exchange"] for scene in (begun(core, sky), begun(core, air))]
    assert both[0] == pytest.approx(both[1], rel=1e-3)


def begun(core, surfaces):
    """A scene whose surroundings are written, as before its first heat step."""
    scene = build(core.experiment(1, surfaces=surfaces))
    for body, around in zip(scene.bodies, scene.surroundings, strict=True):
        around.write(scene.space, body, 0.0, 1e-3)
    return scene
