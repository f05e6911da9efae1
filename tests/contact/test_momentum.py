"""Bodies that collide off their middles while they turn: momentum and angular momentum of both, to rounding."""

import numpy as np
import pytest
from contact_scenes import count

import mpm

pytestmark = pytest.mark.plain
H = 0.125


def collision(dimension):
    """A disc or box that flies at a larger one that turns, past its middle."""
    D = count(dimension)
    aside = [0.0] * (D - 2)
    small = {"ball": {"centre": [0.55, 0.9], "radius": 0.15}} if D == 2 else {"box": {"lower": [0.63, 0.8, 0.45], "upper": [0.78, 0.95, 0.6]}}
    turn = 0.7 if D == 2 else [0.3, -0.4, 0.7]
    material = lambda density, E, nu: {"density": density, "elastic": {"hencky": {"E": E, "nu": nu}}}  # noqa: E731
    return {
        "grid": {"dimension": dimension, "size": [1.75] * D, "cell": H},
        "bodies": {
            "a": {"shape": small, "material": "m", "velocity": [0.8, *aside, -0.1], "angular_velocity": turn},
            "b": {"shape": {"box": {"lower": [0.8, 0.75, 0.5][:D], "upper": [1.05, 1.2, 0.75][:D]}}, "material": "k", "angular_velocity": turn},
        },
        "materials": {"m": material(1.0, 10.0, 0.3), "k": material(2.0, 5.0, 0.2)},
        "time": {"end": 0.35 if D == 2 else 0.15}, "output": {"every": 0.05},
    }  # fmt: skip


def momenta(bodies, D):
    """Momentum (D,) and angular momentum about the origin (1,) or (3,), with that of the particles' own slopes: m h^2/4 C."""
    p, L = np.zeros(D), np.zeros((D, D))
    for body in bodies:
        m, x, v, C = (np.asarray(array, float) for array in (body.particles.m, body.particles.x, body.particles.v, body.particles.C))
        p += m @ v
        L += np.einsum("p,pa,pb->ab", m, v, x) + 0.25 * H**2 * np.einsum("p,pab->ab", m, C)
    return p, (L - L.T)[np.tril_indices(D, -1)]


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_momenta_of_a_pair_without_friction(core, dimension):
    """Both act at one point along its normal, and their weights take every speed that is linear in place: 1e-12 of what they pass to each other.

    By APIC: what FLIP carries does not keep angular momentum of a body alone either."""
    started = []
    scene, run = core.play(mpm.load(collision(dimension)), prepare=lambda scene: started.extend(momenta(scene.bodies, dimension)))
    passed = np.abs(np.sum([run.series[f"force_a_b_{axis}"] for axis in "xyz"[:dimension]], axis=1)).max() * 0.05
    assert run.outcome.ok and passed > 0.01 * started[0][0]
    p, L = momenta(scene.bodies, dimension)
    assert np.abs(p - started[0]).max() < 1e-12 * passed
    assert np.abs(L - started[1]).max() < 1e-12 * passed
