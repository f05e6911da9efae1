"""Walls, shapes, step limits and what is told of the physics, over menu and solver: each kind acts, or the config is refused where it stands.

Exchange, programmes and loads are in tests/test_menus.py, observables and fields in tests/test_answers.py.
"""

import math

import numpy as np
import pytest

import mpm
from mpm.boundary import CONTACT, KINDS
from mpm.config import ConfigError
from mpm.config.bodies import SHAPES
from mpm.config.boundary import EXCHANGES, WALLS
from mpm.config.loads import LOADS
from mpm.config.shapes_fit import WHERE
from mpm.costs import estimate
from mpm.heat.exchange import STEFAN_BOLTZMANN
from mpm.scene.build import build, sample
from mpm.scene.inventory import physics
from mpm.scene.rigid import rigid_bodies
from mpm.scene.shapes import cut_quadrature

pytestmark = pytest.mark.plain

HEAT = {"fourier": {"kappa": 0.1, "alpha": 1.5}}
MATTER = {"rigid": {"density": 2.0, "heat": HEAT}, "moving": {"density": 2.0, "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}}, "heat": HEAT}}
POINT = {"point": {"surface_to_volume": 2.0}}


def config(solver, dimension=1, shape=None, **more):
    """A body at the left of the domain in a solver's config."""
    directions = {"axisymmetric": 2, "point": 0}.get(dimension, dimension)
    data = {
        "grid": {"dimension": dimension, "size": [2.0] * directions, "cell": 0.125},
        "bodies": {"body": {"shape": shape or {"box": {"lower": [0.0] * directions, "upper": [0.75] * directions}}, "temperature": 300.0, "material": "m"}},
        "materials": {"m": MATTER["rigid" if solver in ("rigid", "point") else "moving"]}, "time": {"end": 0.5}, "output": {"every": 0.1},
    }  # fmt: skip
    if solver == "point":
        data |= {"grid": {"dimension": 0}, "bodies": {"body": {"shape": POINT, "temperature": 300.0, "material": "m"}}}
    return data | ({"method": {"frame": "total"}} if solver == "total" else {}) | more


def refused(data):
    """Paths at which a config is refused; none where it loads."""
    try:
        mpm.load(data)
    except ConfigError as told:
        return {problem.path for problem in told.problems}
    return set()


@pytest.mark.parametrize("solver", ["moving", "total", "rigid", "point"])
@pytest.mark.parametrize("kind", [one.kind for one in WALLS])
def test_wall(kind, solver):
    data = config(solver, walls={"left": {kind: {}}})
    found = refused(data)
    if solver in ("rigid", "point"):
        assert any(path.startswith("walls") for path in found)
    elif (kind, solver) == ("contact", "total"):
        assert found == {"walls.left"}
    else:
        walls = build(mpm.load(data)).walls
        assert not found and walls[0, 0] == {**KINDS, "contact": CONTACT}[kind] and (solver == "total" or walls[0, 1] == CONTACT)


SIZES = {  # kind: (of the config by directions, content in 1-D, plane, axisymmetric (a radian), 3-D)
    "box": (lambda n: {"lower": [0.0] * n, "upper": [0.75] * n}, {1: 0.75, 2: 0.75**2, "axisymmetric": 0.75**3 / 2, 3: 0.75**3}),
    "ball": (lambda n: {"centre": [0.0, 1.0] if n == "r" else [1.0] * n, "radius": 0.5},
             {1: 1.0, 2: math.pi / 4, "axisymmetric": 2 / 3 * 0.5**3, 3: 4 / 3 * math.pi * 0.5**3}),
    "cylinder": (lambda n: {"radius": 0.5, "height": 0.75, "base": [0.0, 0.25] if n == "r" else [1.0, 1.0, 0.25][-n:]},
                 {"axisymmetric": 0.5**2 / 2 * 0.75, 3: math.pi * 0.5**2 * 0.75}),
    "ring": (lambda n: {"centre": [1.0] * n, "inner": 0.25, "outer": 0.75}, {2: math.pi * 0.5}),
    "polygon": (lambda n: {"vertices": [[0.25, 0.25], [1.25, 0.25], [0.25, 1.25]]}, {2: 0.5, "axisymmetric": 0.5 * (0.25 + 1 / 3)}),
}  # fmt: skip


def shaped(kind, dimension):
    return {kind: SIZES[kind][0]("r" if dimension == "axisymmetric" and kind in ("ball", "cylinder") else 2 if dimension == "axisymmetric" else dimension)}


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
@pytest.mark.parametrize("kind", SIZES)
def test_shape(kind, dimension):
    """Its whole content, in particles and in the quadrature of bodies that do not move; or the dimension is refused at the shape."""
    if dimension not in SIZES[kind][1]:
        found = [refused(config(solver, dimension, shaped(kind, dimension))) for solver in ("moving", "total", "rigid")]
        assert all(any(path.startswith("bodies.body.shape") for path in paths) for paths in found)
        return
    exact = SIZES[kind][1][dimension]
    moving = mpm.load(config("moving", dimension, shaped(kind, dimension)))
    assert sample(moving, "body")[0].volume.sum() == pytest.approx(exact, rel=2e-3)
    (body,) = rigid_bodies(mpm.load(config("rigid", dimension, shaped(kind, dimension))))
    lower, upper = body.shape.bounds()
    radial = dimension == "axisymmetric"
    lower = np.maximum(lower, [0.0, -np.inf]) if radial else lower
    inside = cut_quadrature(body.shape, [np.linspace(a, b, 9) for a, b in zip(lower, upper, strict=True)], 3)[0]
    assert (inside.w * (inside.x[:, 0] if radial else 1.0)).sum() == pytest.approx(exact, rel=2e-3)


def test_shapes_are_the_menu_and_only_a_point_is_a_point():
    assert {one.kind for one in SHAPES} == {*SIZES, "mesh", "point"}  # a mesh is a file: tests/scene/test_mesh.py
    assert {one.kind: set(where) for one, where in WHERE.items()} == {kind: set(exact) for kind, (_, exact) in SIZES.items()} | {"mesh": {3}, "point": {0}}
    assert any(path.startswith("bodies.body.shape") for path in refused(config("moving", 1, POINT)))


ENTRY = {  # with the slope of what passes [W/(m2 K)]
    "convection": ({"beta": 0.5, "outside": 300.0}, 0.5),
    "fixed": ({"temperature": 300.0}, 1000 * 0.1 / 0.125),  # stands for infinity: docs/physics.md 3
    "flux": ({"q": 1.0}, 0.0),
    "radiation": ({"emissivity": 0.5, "surroundings": 3000.0}, 4 * 0.5 * STEFAN_BOLTZMANN * 3000.0**3),
}


@pytest.mark.parametrize("kind", EXCHANGES)
def test_step_limit_and_physics_know_the_exchange(kind):
    """R0 alpha h/(2 slope) bounds the explicit heat step, none where a flux is given; each is told as physics."""
    entry, slope = ENTRY[kind]
    plain = config("moving", method={"heat": {"explicit": {}}})
    with_it = mpm.load(plain | {"surfaces": [{"of": "body", kind: entry}]})
    limits = estimate(with_it)["limits"]
    assert limits.get("surface exchange", math.inf) == pytest.approx(2.0 * 1.5 * 0.125 / (2 * slope) if slope else math.inf, rel=1e-6)
    assert "surface exchange" not in estimate(mpm.load(plain))["limits"]
    assert f"exchange: {kind}" in physics(with_it)["compiled"] and "exchange" in physics(mpm.load(plain))["absent"]


@pytest.mark.parametrize("kind", LOADS)
def test_physics_knows_the_load(kind):
    entry = {"traction": {"side": "right", "traction": {"nominal": [0.2]}}, "drag": {"drag": {"rate": 2.0}}}[kind]
    assert f"load: {kind}" in physics(mpm.load(config("moving", loads=[{"of": "body"} | entry])))["compiled"]
