"""Surfaces of moving bodies: areas by Nanson, offsets by F, and the area that a config's shapes get."""

import math

import numpy as np
import pytest

from mpm.heat.surface import area_and_offset
from mpm.scene.build import build
from mpm.state import Axisymmetric, Line, Plane, Volume

SPACES = {1: Line(0.1, 9), 2: Plane(0.1, 9, 9), "axisymmetric": Axisymmetric(0.1, 9, 9), 3: Volume(0.1, 9, 9, 9)}


@pytest.mark.parametrize("dimension", SPACES)
def test_nanson(core, dimension):
    """a = J F^-T A with the stretch out of the plane in J; d = F D."""
    rng, D = np.random.default_rng(7), core.DIRECTIONS[dimension]
    for _ in range(5):
        F = np.eye(D) + 0.3 * rng.standard_normal((D, D))
        out = rng.uniform(0.5, 1.5) if dimension == "axisymmetric" else 1.0
        J = out * np.linalg.det(F)
        A, offset, into = rng.standard_normal(D), rng.standard_normal(D), np.zeros((D, 4))
        area = area_and_offset(SPACES[dimension], F[None], 0, J, A[None], offset[None], 0, into)
        expected = np.linalg.norm(J * np.linalg.inv(F).T @ A) if D > 1 else abs(A[0])
        assert area == pytest.approx(abs(expected), rel=1e-12)
        assert np.allclose(into[:, 0], F @ offset, rtol=1e-13)


CASES = {
    "bar": (1, {"box": {"lower": [0.6], "upper": [1.35]}}, 2.0, 0.75),
    "rotated box": (2, {"box": {"lower": [0.6, 0.7], "upper": [1.35, 1.2], "angle": 0.5}}, 2.5, 0.375),
    "disc": (2, {"ball": {"centre": [1.03, 0.98], "radius": 0.6}}, 1.2 * math.pi, 0.36 * math.pi),
    "cylinder": ("axisymmetric", {"cylinder": {"radius": 0.6, "height": 1.1, "base": [0, 0.3]}}, 0.36 + 0.6 * 1.1, 0.18 * 1.1),
    "sphere, per radian": ("axisymmetric", {"ball": {"centre": [0, 1.03], "radius": 0.6}}, 2 * 0.36, 2 / 3 * 0.216),
    "box": (3, {"box": {"lower": [0.6] * 3, "upper": [1.35, 1.1, 1.6]}}, 2 * (0.75 * 0.5 + 0.75 + 0.5), 0.375),
    "sphere": (3, {"ball": {"centre": [1.03, 0.98, 1.0], "radius": 0.6}}, 4 * math.pi * 0.36, 4 / 3 * math.pi * 0.216),
}


@pytest.mark.parametrize("name", CASES)
def test_areas_and_volumes_of_a_scene(core, name):
    """Sum S is the body's area, sum V its volume, at any place between the grid lines; the surface is closed (sum of normals zero)."""
    dimension, shape, area, volume = CASES[name]
    changes = {"bodies": {"body": {"shape": shape, "temperature": 400, "material": "solid"}}}
    body = build(core.experiment(dimension, **changes)).bodies[0]
    pieces = np.linalg.norm(body.surface.area, axis=1)
    pieces = pieces[pieces > 1e-6 * pieces.max()]  # less the corners by which bodies meet, which are no faces
    assert pieces.sum() == pytest.approx(area, rel=5e-3 if "sphere" in name or name == "disc" else 1e-10)
    assert body.particles.V0.sum() == pytest.approx(volume, rel=1e-3 if "sphere" in name or name == "disc" else 1e-10)
    assert body.particles.m.sum() == pytest.approx(2.0 * volume, rel=1e-3 if "sphere" in name or name == "disc" else 1e-10)
    if dimension in (1, 2, 3):
        assert np.allclose(body.surface.area.sum(axis=0), 0, atol=2e-3)
