"""XPIC and affine FLIP, for velocity and for temperature: what they keep, and how much they damp."""

import numpy as np
import pytest

from mpm.integrate.xpic import sharpened

pytestmark = pytest.mark.plain

CELLS, H = 32, 1 / 32


def warm_box(core, kind, dimension=1, latent=0.0, beta=1e-12, kappa=1e-9, box=(0.0, 1.0), heat_step="auto", temperature=None):
    """A soft body at rest that fills its box: mirror walls continue its modes. One set of physics, so that each transfer compiles once."""
    D = core.DIRECTIONS[dimension]
    alpha = {"bump": {"base": 1.5, "heat": latent, "at": 299, "width": 2}}
    return core.experiment(
        grid={"dimension": dimension, "size": [1.0] * D, "cell": H if dimension == 1 else 0.1},
        bodies={"body": {"shape": {"box": {"lower": [box[0]] * D, "upper": [box[1]] * D}}, "temperature": 300.0, "material": "solid"}},
        materials={"solid": {"density": 2.0, "elastic": {"hencky": {"lam": 0, "mu": 1e-9}}, "heat": {"fourier": {"kappa": kappa, "alpha": alpha}}}},
        surfaces=[{"of": "body", "convection": {"beta": beta, "outside": 290.0}}],
        time={"end": 0.1, "step": 0.01},
        output={"every": 0.02},
        method={"transfer": kind, "temperature": temperature or kind, "heat_step": heat_step},
    )


def mode(x, field, even):
    """Amplitude of the mode cos (even) or sin of 3 half waves, by least squares."""
    wave = (np.cos if even else np.sin)(3 * np.pi * x)
    return field @ wave / (wave @ wave)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_damping_of_temperature_and_velocity(core, order):
    """A mode loses (k h/2)^(2 order) of itself a step, with walls as mirrors. Here k h/2 = 0.147."""
    from mpm.guards import Guards
    from mpm.scene.build import build
    from mpm.simulation import Clock, march, work_arrays

    scene = build(warm_box(core, {"xpic": {"order": order}}))
    body, work = scene.bodies[0], work_arrays(scene)
    x = body.particles.x[:, 0].copy()
    body.thermal.theta[:] = np.cos(3 * np.pi * x)
    lost = sharpened(scene.space, body, work.rows[:4], scene.walls, order)
    expected = (3 * np.pi * H / 2) ** (2 * order)
    assert -mode(x, lost, True) == pytest.approx(expected, rel=0.05)
    assert abs(np.sum(lost)) < 1e-13 and not np.any(work.rows)
    scene.step = 1e-9
    body.particles.v[:, 0] = np.sin(3 * np.pi * x)
    assert march(scene, Clock(scene), Guards(scene), work, 1e-9, lambda: False).ok
    assert 1 - mode(x, body.particles.v[:, 0], False) == pytest.approx(expected, rel=0.05)
    assert not any(np.any(array) for array in (work.buffers.nodes, work.buffers.force))


def test_pic_temperature_conducts_by_itself(core):
    """Spurious conductivity R0 alpha h^2/(4 dt) (docs/physics.md 3): smaller steps are worse."""

    def wave(scene):
        scene.bodies[0].thermal.theta[:] = np.cos(3 * np.pi * scene.bodies[0].particles.x[:, 0])

    for step in (0.01, 0.005):
        scene, run = core.play(warm_box(core, {"xpic": {"order": 2}}, heat_step=step, temperature="pic"), wave)
        rate = -np.log(mode(scene.bodies[0].particles.x[:, 0], scene.bodies[0].thermal.theta, True)) / 0.1
        assert run.outcome.ok and rate / (3 * np.pi) ** 2 == pytest.approx(H**2 / (4 * step), rel=0.05)


KINDS = [{"xpic": {"order": 3}}, {"affine_flip": {"blend": 0.02}}]
over_kinds = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: next(iter(kind)))


def shaken(core, kind, dimension):
    """Noise everywhere, exchange and latent heat."""

    def shake(scene):
        rng, body = np.random.default_rng(1), scene.bodies[0]
        body.particles.v[:] = 0.02 * rng.standard_normal(body.particles.v.shape)
        body.thermal.theta[:] = rng.standard_normal(body.thermal.theta.shape)

    return core.play(warm_box(core, kind, dimension, latent=30.0, beta=2.0, kappa=0.05, box=(0.33, 0.68), heat_step=0.01), shake)


@over_kinds
def test_momentum_and_ledger(core, kind):
    """Momentum to round-off, the ledger to 1e-12 of what was exchanged."""
    _, run = shaken(core, kind, 1)
    assert run.outcome.ok and run.finals["heat_exchanged"] < -0.1
    assert np.max(np.abs(run.series["heat_ledger"])) < 1e-12 * abs(run.finals["heat_exchanged"])
    assert np.ptp(run.series["momentum_x"]) < 1e-14


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
@over_kinds
def test_momentum_and_ledger_in_more_directions(core, kind, dimension):
    _, run = shaken(core, kind, dimension)
    assert run.outcome.ok and np.max(np.abs(run.series["heat_ledger"])) < 1e-12 * abs(run.finals["heat_exchanged"])
    assert np.ptp(run.series["momentum_z" if dimension != 2 else "momentum_y"]) < 1e-14
