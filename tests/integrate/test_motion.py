"""What motion must keep: mass, momentum, temperature of a uniform body, strain in a rotation, the adiabat, thermal stretch."""

import numpy as np
import pytest

from mpm.diagnostics import strains

DIMENSIONS = [1, 2, "axisymmetric", 3]
# Each costs a compilation: APIC with its own gradient in the plane; every dimension with both schemes and both gradients; the other two pairs.
MARKS = {("apic", "mls"): [pytest.mark.wide], ("flip", "bspline"): [pytest.mark.wide]}
PAIRS = [
    pytest.param(dimension, *pair, marks=[] if (dimension, *pair) == (2, "apic", "mls") else MARKS.get(pair, [pytest.mark.slow]))
    for dimension in DIMENSIONS
    for pair in (("apic", "mls"), ("apic", "bspline"), ("flip", "mls"), ("flip", "bspline"))
]
over_pairs = pytest.mark.parametrize(("dimension", "transfer", "gradient"), PAIRS)


def stir(scene):
    """A smooth velocity field that stretches and shears, and a velocity of the whole; tangential only at the axis."""
    p, D = scene.bodies[0].particles, scene.bodies[0].particles.x.shape[1]
    rates = 0.3 * np.array([[0.9, 0.5, -0.4], [-0.7, -0.6, 0.8], [0.3, 0.6, 0.7]])[:D, :D]
    drift = np.array([0.3, -0.2, 0.25])[:D]
    if type(scene.space).__name__ == "Axisymmetric":
        rates, drift = 0.3 * np.diag([0.9, -0.6]), np.array([0.0, -0.2])
    p.v[:] = (p.x - np.array([0.0, 1.0, 1.0])[:D]) @ rates.T + drift
    p.C[:] = rates


def air(core):
    """Air 37 K above the temperature from which temperatures are counted."""
    return [{"of": "body", "convection": {"beta": 0.5, "outside": core.HOT + 37.0}}]


@over_pairs
def test_mass_momentum_and_uniform_temperature(core, dimension, transfer, gradient):
    """A body that flies and deforms: mass to the bit, momentum to 1e-13, and 437 K stays 437 K though nothing pins it."""

    def prepare(scene):
        stir(scene)
        scene.bodies[0].thermal.theta[:] = 37.0

    scene, run = core.play(core.experiment(dimension, surfaces=air(core), method=core.methods(transfer, gradient)), prepare)
    assert run.outcome.ok and run.steps > 3
    body = scene.bodies[0]
    assert np.ptp(run.series["mass_total"]) == 0.0
    assert np.abs(run.series["J_max"] - 1).max() > 0.02, "the body should deform"
    assert np.abs(body.thermal.theta - 37.0).max() < 1e-12 * 37.0 * (1 + run.steps)
    for axis in {1: "x", 2: "xy", "axisymmetric": "z", 3: "xyz"}[dimension]:
        momentum = run.series[f"momentum_{axis}"]
        assert np.abs(momentum - momentum[0]).max() < 1e-13 * abs(momentum[0])


def test_apic_keeps_angular_momentum(core):
    def spin(p):
        return np.sum(p.m * (p.x[:, 0] * p.v[:, 1] - p.x[:, 1] * p.v[:, 0])) + 0.25**2 / 4 * np.sum(p.m * (p.C[:, 1, 0] - p.C[:, 0, 1]))

    start = []

    def prepare(scene):
        stir(scene)
        start.append(spin(scene.bodies[0].particles))

    scene, run = core.play(core.experiment(2), prepare)
    assert run.outcome.ok
    assert spin(scene.bodies[0].particles) == pytest.approx(start[0], rel=1e-12)


OMEGA = {2: 1.5, 3: [0.5, -0.8, 1.2]}


def turning(core, dimension, end, step, **method):
    D = core.DIRECTIONS[dimension]
    body = {"shape": {"box": {"lower": [0.6] * D, "upper": [1.35] * D}}, "temperature": core.HOT, "material": "solid", "angular_velocity": OMEGA[dimension]}
    return core.experiment(dimension, bodies={"body": body}, surfaces=air(core), time={"end": end, "step": step}, output={"every": end}, method=method)


@pytest.mark.plain
@pytest.mark.parametrize("dimension", [2, 3])
def test_one_step_of_rotation_strains_by_the_explicit_drift(core, dimension):
    """F = 1 + dt W: two principal strains grow by 1/2 ln(1 + Omega^2 dt^2) = 1/2 Omega^2 dt^2, the one along the axis by nothing."""
    dt = 0.01
    scene, run = core.play(turning(core, dimension, dt, dt))
    assert run.steps == 1
    e = np.sort(strains(scene.space, scene.bodies[0].particles.B), axis=1)
    drift = 0.5 * np.log1p(np.sum(np.square(OMEGA[dimension])) * dt**2)
    assert np.allclose(e[:, 0], 0.0, atol=1e-14) and np.allclose(e[:, 1:], drift, rtol=1e-9)


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.wide)])
def test_rotation_keeps_temperature_and_strains_within_drift_and_centrifugal_load(core, dimension):
    """A fifth of a turn: strain within 1/2 Omega^2 dt t and rho Omega^2 R^2/mu, temperature to round-off."""
    dt, end = 0.01, 0.8

    def prepare(scene):
        scene.bodies[0].thermal.theta[:] = 37.0

    scene, run = core.play(turning(core, dimension, end, dt), prepare)
    assert run.outcome.ok
    rate = np.sum(np.square(OMEGA[dimension]))
    e = strains(scene.space, scene.bodies[0].particles.B)
    assert np.abs(e).max() < 0.5 * rate * dt * end + 2.0 * rate * 2 * 0.375**2 / 2.0
    assert np.abs(scene.bodies[0].thermal.theta - 37.0).max() < 1e-12 * 37.0 * run.steps


@pytest.mark.plain
@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_adiabatic_compression(core, dimension):
    """No conduction to speak of, one heat step at the start: every particle stays on Theta = Theta_0 J^-Gamma, whatever the motion."""
    changes = {"kappa": 1e-30, "beta": 1e-30, "materials.solid.expansion.modulus.gamma": 0.006, "output.every": 0.5}
    scene, run = core.play(core.experiment(dimension, changes), stir)
    body = scene.bodies[0]
    exponent = body.expansion.gamma / (2.0 * 1.5)
    assert run.outcome.ok and np.abs(body.particles.J - 1).max() > 0.02
    assert np.allclose(core.HOT + body.thermal.theta, core.HOT * body.particles.J**-exponent, rtol=1e-12, atol=0)


STRETCH = {1: ("uniaxial_stretch", 1), 2: ("planestrain_inplane_stretch", 2), "axisymmetric": ("free3D_J", 1), 3: ("free3D_J", 1)}


@pytest.mark.parametrize("dimension", [pytest.param(each, marks=pytest.mark.plain if each == 1 else pytest.mark.wide) for each in DIMENSIONS])
def test_free_thermal_expansion(core, dimension):
    """A body that is warmer than its reference swells to its exact stretch (thermal_expansion.csv); PIC damps the ringing.

    Where no node is pulled the mean of tau is zero, so the mean of ln J is exact; stresses that no node feels leave the particles 3e-4 of J apart.
    """
    row = core.table("thermal_expansion.csv")[2]
    column, power = STRETCH[dimension]
    scale = 1e-5  # moduli of the table in units that make waves slow
    material = {
        "density": 1.0,
        "elastic": {"hencky": {"lam": scale * row["lambda"], "mu": scale * row["mu"]}},
        "heat": {"fourier": {"kappa": 1e-6, "alpha": 1e9}},  # so large a heat capacity that swelling does not cool
        "expansion": {"modulus": {"gamma": scale * row["c_lambda"], "reference": core.HOT - row["dTheta"]}},
        "heating": {"elastic": {}},
    }
    method = core.methods("pic", "bspline")
    scene, run = core.play(core.experiment(dimension, materials={"solid": material}, time={"end": 40.0}, output={"every": 20.0}, method=method))
    assert run.outcome.ok
    body = scene.bodies[0]
    assert np.average(np.log(body.particles.J), weights=body.particles.m) == pytest.approx(power * np.log(row[column]), rel=1e-6)
    assert np.average(body.particles.J, weights=body.particles.m) == pytest.approx(row[column] ** power, rel=1e-6)
    assert np.allclose(body.particles.J, row[column] ** power, rtol=1e-3)


def test_clamped_body_carries_the_thermal_stress(core):
    """Between two walls nothing moves, and the pressure is gamma (Theta - Theta_0)."""
    body = {"body": {"shape": {"box": {"lower": [0], "upper": [2]}}, "temperature": core.HOT, "material": "solid"}}
    changes = {"materials.solid.expansion.modulus.gamma": 0.01, "materials.solid.expansion.modulus.reference": core.HOT - 50}
    scene, run = core.play(core.experiment(1, changes, bodies=body))
    assert np.allclose(run.series["pressure_mean"], 0.5, rtol=1e-12)
    assert np.abs(scene.bodies[0].particles.v).max() < 1e-14 and np.abs(scene.bodies[0].particles.B).max() < 1e-14
