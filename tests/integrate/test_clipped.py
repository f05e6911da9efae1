"""`map: clipped` from the config to the particles."""

import math

import numpy as np
import pytest

from mpm.diagnostics import strains
from mpm.materials import EllipseClipped

pytestmark = pytest.mark.plain

M, MU = 0.02, 2.0


def test_shear_is_clipped_whatever_the_viscosity(core):
    """A bar thrown at a wall: with `radial` and this viscosity nothing would flow."""
    flow = {"ellipse": {"M": M, "p0": 50.0, "eta": 1e6, "map": "clipped"}}
    materials = {"solid": {"density": 2.0, "elastic": {"hencky": {"lam": 3.0, "mu": MU}}, "flow": flow}}
    body = {"shape": {"box": {"lower": [0.0], "upper": [0.75]}}, "material": "solid", "velocity": [-0.2]}
    scene, run = core.play(core.experiment(materials=materials, surfaces=[], bodies={"body": body}))
    assert run.outcome.ok and isinstance(scene.bodies[0].flow, EllipseClipped)
    e = strains(scene.space, scene.bodies[0].particles.B)
    q = math.sqrt(6) * MU * np.linalg.norm(e - e.mean(axis=1, keepdims=True), axis=1)
    assert np.max(q) <= M * (1 + 1e-9)
    assert np.min(scene.bodies[0].particles.J) < 0.97 and run.finals["dissipation_total"] > 0
