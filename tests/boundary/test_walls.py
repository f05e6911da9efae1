"""Walls as mirrors: exact for linear fields, for a body and its image, and a contact wall lets go."""

import numpy as np
import pytest

from mpm.boundary import CONTACT, SLIP, STICK
from mpm.boundary.walls import fold, impose, unfold
from mpm.state import PAD

pytestmark = pytest.mark.plain

H = 0.25


def plane(wall, n=9):
    """Nodes (n n, 3) of a plane: velocity of a linear field that the left wall allows, mass one; and its box, shape and walls."""
    at = (np.arange(n) - PAD) * H
    x, y = np.meshgrid(at, at, indexing="ij")
    field = np.stack([0.7 * x, 0.4 * x if wall == STICK else 0.3 + 0.5 * y, np.ones_like(x)], axis=-1)
    walls = np.full((3, 2), CONTACT)
    walls[0, 0] = wall
    return field.reshape(-1, 3).copy(), (n, n, 1), np.array([[PAD - 1, n - 3], [PAD + 1, n - PAD - 1], [0, 1]]), walls


@pytest.mark.parametrize("wall", [SLIP, STICK])
def test_a_linear_field_is_continued_through_the_wall(wall):
    """Reflection restores the ghost nodes of a field that is odd in what the wall holds; slip leaves a tangential field that varies along the wall."""
    expected, shape, box, walls = plane(wall)
    nodes = expected.copy()
    nodes[(PAD - 1) * 9 : PAD * 9, :2] = 99.0
    impose(nodes, 2, shape, box, walls)
    unfold(nodes, 2, shape, box, walls)
    found, expected = (field.reshape(9, 9, 3)[PAD - 1 : -3, PAD + 1 : -PAD - 1] for field in (nodes, expected))
    assert np.allclose(found, expected)


@pytest.mark.parametrize("wall", [SLIP, STICK])
def test_fold_is_the_mirrored_body(wall):
    """What lands outside is added to its image, odd in the held components: mass and the free components keep their sums."""
    rng = np.random.default_rng(3)
    nodes, shape, _, walls = plane(wall)
    nodes[:] = rng.standard_normal(nodes.shape)
    box = np.array([[PAD - 1, 9 - 3], [PAD + 1, 9 - PAD - 1], [0, 1]])
    before = nodes.copy().reshape(9, 9, 3)
    fold(nodes, 2, shape, box.copy(), walls)
    after = nodes.reshape(9, 9, 3)
    sign, inner = np.array([-1.0, -1.0 if wall == STICK else 1.0, 1.0]), slice(PAD + 1, -PAD - 1)
    assert np.allclose(after[PAD + 1, inner], before[PAD + 1, inner] + sign * before[PAD - 1, inner])
    assert np.array_equal(after[PAD + 2 :], before[PAD + 2 :]) and np.array_equal(after[PAD], before[PAD])


def shearing(core, dimension, wall, rates, at):
    """One step of a body on the bottom wall (left, in 1-D) with velocity rates (x - at): velocities afterwards, and what they were."""
    D = core.DIRECTIONS[dimension]
    lower, upper = [0.6] * (D - 1) + [0.0], [1.35] * (D - 1) + [0.8]
    body = {"body": {"shape": {"box": {"lower": lower, "upper": upper}}, "temperature": core.HOT, "material": "solid"}}
    side = "left" if dimension == 1 else "bottom"
    before = []

    def prepare(scene):
        p = scene.bodies[0].particles
        p.v[:] = (p.x - at) @ np.array(rates).T
        p.C[:] = rates
        before.append(p.v.copy())

    experiment = core.experiment(dimension, bodies=body, walls={side: wall}, time={"end": 1e-3, "step": 1e-3}, output={"every": 1e-3})
    scene, run = core.play(experiment, prepare)
    assert run.outcome.ok and run.steps == 1
    p = scene.bodies[0].particles
    return p.v, p.C, before[0]


SLIDES = [
    (1, "slip", [[0.7]]),
    (1, "stick", [[0.7]]),
    (2, "slip", [[0.3, 0.0], [0.0, -0.6]]),
    (2, "stick", [[0.0, 0.8], [0.0, -0.6]]),
    (3, "slip", [[0.3, 0.2, 0.0], [-0.5, 0.1, 0.0], [0.0, 0.0, 0.7]]),
    (3, "stick", [[0.0, 0.0, 0.8], [0.0, 0.0, -0.4], [0.0, 0.0, 0.7]]),
]


@pytest.mark.parametrize(("dimension", "wall", "rates"), SLIDES)
def test_a_linear_velocity_passes_through_a_step(core, dimension, wall, rates):
    """Slip keeps a field with v_n = 0 on the wall, stick one with v = 0 there, to round-off, gradient too, right up to the wall."""
    D = core.DIRECTIONS[dimension]
    at = np.array([1.0] * (D - 1) + [0.0])
    v, C, before = shearing(core, dimension, wall, rates, at)
    assert np.allclose(v, before, atol=1e-14) and np.allclose(C, rates, atol=1e-13)


def test_stick_holds_what_slip_lets_slide(core):
    """A block that slides along the bottom keeps its momentum on a slip wall and loses it to a stick wall."""
    body = {"shape": {"box": {"lower": [0.5, 0.0], "upper": [1.0, 0.5]}}, "temperature": core.HOT, "material": "solid", "velocity": [0.4, 0.0]}
    momentum = {}
    for wall in ("slip", "stick"):
        run = core.play(core.experiment(2, bodies={"body": body}, walls={"bottom": wall}))[1]
        assert run.outcome.ok
        momentum[wall] = run.series["momentum_x"]
    assert np.allclose(momentum["slip"], momentum["slip"][0], rtol=1e-13)
    assert momentum["stick"][-1] < 0.5 * momentum["stick"][0]


def against_the_wall(core, wall, velocity, end=0.8):
    body = {"shape": {"box": {"lower": [0.0], "upper": [0.75]}}, "temperature": core.HOT, "material": "solid", "velocity": [velocity]}
    return core.play(core.experiment(1, bodies={"body": body}, walls={"left": wall}, time={"end": end}))[1]


def test_contact_lets_go_and_slip_does_not(core):
    """A body that leaves the wall: contact takes nothing from it, slip holds its end."""
    free, held = against_the_wall(core, "contact", 0.3), against_the_wall(core, "slip", 0.3)
    assert np.allclose(free.series["momentum_x"], free.series["momentum_x"][0], rtol=1e-13)
    assert free.series["position_min_x"][-1] - free.series["position_min_x"][0] == pytest.approx(0.3 * 0.8, rel=1e-12)
    assert held.series["position_min_x"][-1] < 0.1 and held.series["momentum_x"][-1] < 0


def test_contact_turns_a_body_back(core):
    """A thrown body bounces: it never passes the wall, and comes back with all of its momentum but what a surface of one cell loses (here 12 cells)."""
    body = {"shape": {"box": {"lower": [0.5], "upper": [1.25]}}, "temperature": core.HOT, "material": "solid", "velocity": [-0.4]}
    changes = {"kappa": 1e-6, "time.end": 4.0, "method.particles": 4, "grid.cell": 0.0625}
    run = core.play(core.experiment(1, changes, bodies={"body": body}, walls={"left": "contact"}))[1]
    assert run.outcome.ok and run.series["position_min_x"].min() > -0.01 * 0.0625  # of the outline, fitted to the particles: 0.01 cells
    assert run.series["momentum_x"][-1] > -0.8 * run.series["momentum_x"][0]


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_slip_wall_is_a_mirror(core, dimension):
    """Half a body against a slip wall, cooling and ringing, is half of the doubled body, to 1e-12."""
    D = core.DIRECTIONS[dimension]
    rest = ([0.6], [1.1]) if D == 2 else ([], [])

    def shape(lower, upper):
        return {"body": {"shape": {"box": {"lower": [lower, *rest[0]], "upper": [upper, *rest[1]]}}, "temperature": core.HOT, "material": "solid"}}

    air = {"convection": {"beta": 0.5, "outside": core.COLD}}
    sides = ["right"] if dimension == 1 else ["right", "top", "bottom"]
    grid = {"dimension": dimension, "size": [4.0] + [2.0] * (D - 1), "cell": 0.25}

    def ring(scene):
        p = scene.bodies[0].particles
        middle = 2.0 if p.x[:, 0].min() > 1.0 else 0.0
        p.v[:, 0], p.C[:, 0, 0] = 0.3 * (p.x[:, 0] - middle), 0.3

    changes = {"materials.solid.expansion.modulus.gamma": 0.01, "time.step": 0.02, "method.heat_step": 0.05}
    half = core.play(core.experiment(dimension, changes, bodies=shape(0.0, 0.65), surfaces=[{"of": "body", "side": s} | air for s in sides]), ring)[0].bodies[0]
    surfaces = [{"of": "body", "side": s} | air for s in [*sides, "left"]]
    whole = core.play(core.experiment(dimension, changes, bodies=shape(1.35, 2.65), surfaces=surfaces, grid=grid), ring)[0].bodies[0]
    right = whole.particles.x[:, 0] > 2.0
    assert right.sum() * 2 == len(right) and right.sum() == len(half.particles.m)
    order, other = (np.lexsort(np.round(x, 6).T) for x in (half.particles.x, whole.particles.x[right] - np.array([2.0] + [0.0] * (D - 1))))
    for name in ("v", "B", "J"):
        a, b = getattr(half.particles, name)[order], getattr(whole.particles, name)[right][other]
        assert np.allclose(a, b, rtol=1e-11, atol=1e-12), name
    assert np.allclose(half.particles.x[order, 0] + 2.0, whole.particles.x[right][other][:, 0], rtol=1e-12)
    assert np.allclose(half.thermal.theta[order], whole.thermal.theta[right][other], rtol=1e-11, atol=1e-10)
    assert np.ptp(half.thermal.theta) > 1 and np.abs(half.particles.v).max() > 0.01
