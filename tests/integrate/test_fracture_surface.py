"""Bodies that come apart: the faces that open, their areas, and the heat that leaves through them."""

import numpy as np
import pytest

import mpm
from mpm.diagnostics import exchanging_area
from mpm.integrate.fracture_surface import tear
from mpm.scene.build import build

pytestmark = pytest.mark.plain

GRIDS = {1: [6.0], 2: [6.0, 2.0], "axisymmetric": [2.0, 6.0], 3: [6.0, 1.5, 1.5]}
LENGTH = {1: 0, 2: 0, "axisymmetric": 1, 3: 0}  # the axis along the bar
ENDS = {1: 1.0, 2: 0.75, "axisymmetric": 0.75**2 / 2, 3: 0.75 * 0.5}  # area across it


def bar(core, dimension, **changes):
    """Two long, off the grid lines; no sound to speak of, so that it goes where it is thrown."""
    shapes = {
        1: {"box": {"lower": [2.03], "upper": [4.03]}}, 2: {"box": {"lower": [2.03, 0.61], "upper": [4.03, 1.36]}},
        "axisymmetric": {"cylinder": {"radius": 0.75, "height": 2.0, "base": [0, 2.03]}},
        3: {"box": {"lower": [2.03, 0.41, 0.52], "upper": [4.03, 1.16, 1.02]}},
    }  # fmt: skip
    bodies = {"body": {"shape": shapes[dimension], "temperature": core.HOT, "material": "solid"}}
    soft = {"lam": 1e-9, "mu": 1e-9, "time.step": 5e-3, "method.fracture": "surface"}
    return core.experiment(dimension, soft | changes, bodies=bodies, grid={"dimension": dimension, "size": GRIDS[dimension], "cell": 0.25})


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
def test_a_bar_cut_in_two_has_two_ends_more(core, dimension):
    """Halves moved apart as they are: no mechanics, exact."""
    scene = build(bar(core, dimension))
    body, axis = scene.bodies[0], LENGTH[dimension]
    before = exchanging_area(body)
    assert tear(scene.space, body, scene.seams[0]) == 0
    body.particles.x[:, axis] += np.where(body.particles.x[:, axis] > 3.0, 1.5, 0.0)
    opened = tear(scene.space, body, scene.seams[0])
    assert opened > 0 and exchanging_area(body) - before == pytest.approx(2 * ENDS[dimension], rel=1e-12)
    assert tear(scene.space, body, scene.seams[0]) == 0
    lost = body.surface.area[scene.seams[0].piece[scene.seams[0].torn(body)]]
    assert np.all(lost[:, 0, axis] > 0) and np.allclose(lost.sum(axis=1), 0)


def test_what_slides_past_itself_does_not_open(core):
    """Sheared by three: neighbours lose sight of each other, but others have taken their place."""
    scene = build(bar(core, 2))
    body = scene.bodies[0]
    body.particles.x[:, 0] += 8.0 * (body.particles.x[:, 1] - 0.6)
    body.surface.F[:, 0, 1] = 8.0
    pieces = scene.seams[0].piece
    apart = np.abs(np.diff(body.particles.x[body.surface.owner[pieces], 0], axis=1))
    assert apart.max() > 3 * 0.25 and tear(scene.space, body, scene.seams[0]) == 0


def test_a_bar_thrown_apart(core):
    """Its halves fly off at 1 m/s each, by FLIP, which keeps the speed that a particle was given: one tear, in one place, and both new ends cool."""
    methods = {"method.transfer": {"flip": {}}, "surfaces.0.convection.outside": core.COLD}
    experiment = bar(core, 1, **methods, **{"time.end": 1.0, "output.every": 0.05})

    def throw(scene):
        x = scene.bodies[0].particles.x
        scene.bodies[0].particles.v[:, 0] = np.where(x[:, 0] > 3.0, 1.0, -1.0)

    scene, run = core.play(experiment, throw)
    assert run.outcome.ok, run.outcome
    grown = run.series["area_exchanging"] - run.series["area_exchanging"][0]
    assert grown[5] == 0 and grown[-1] == pytest.approx(2 * ENDS[1], rel=1e-12)
    theta, x = scene.bodies[0].thermal.theta, scene.bodies[0].particles.x[:, 0]
    inner, middle = np.argmin(np.abs(x - 3.0)), np.argmin(np.abs(x - x.min() - 0.5))
    assert theta[inner] < theta[middle] - 1.0
    assert abs(run.finals["heat_ledger"]) < 1e-12 * abs(run.finals["heat_exchanged"])


def test_it_needs_a_surface(core):
    with pytest.raises(mpm.scene.build.SceneError, match=r"method\.fracture: surface"):
        build(bar(core, 1).model_copy(update={"surfaces": ()}))
