"""Tractions as faded stress: the same work on any smooth motion as the traction on the face itself, by another quadrature; and what they leave at pieces."""

import numpy as np
import pytest

import mpm
from mpm.integrate.traction import BORNE, GROWS, ROUGH, turn
from mpm.scene.build import build

pytestmark = pytest.mark.plain
SHAPES = {
    "ring": (2, {"ring": {"centre": [1.51, 1.48], "inner": 0.52, "outer": 1.13}}, "inner"),
    "disc": (2, {"ball": {"centre": [1.51, 1.48], "radius": 1.1}}, "all"),
    "ball": (3, {"ball": {"centre": [1.51, 1.48, 1.53], "radius": 1.1}}, "all"),
    "pillar": (3, {"cylinder": {"base": [1.51, 1.48, 0.3], "radius": 1.1, "height": 1.7}}, "lateral"),
    "pipe": ("axisymmetric", {"box": {"lower": [0.52, 0.0], "upper": [1.63, 3.0]}}, "inner"),
    "slab": (2, {"box": {"lower": [0.3, 0.0], "upper": [1.63, 2.1]}}, "top"),
}


def load_of(name, traction, cell, **changes):
    D, shape, side = SHAPES[name]
    n = {"axisymmetric": 2}.get(D, D)
    body = build(mpm.load({
        "grid": {"dimension": D, "size": [3.0] * n, "cell": cell}, "bodies": {"body": {"shape": shape, "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 1.0, "nu": 0.3}}}}, "time": {"end": 1.0}, "output": {"every": 1.0},
        "loads": [{"of": "body", "side": side, "traction": traction}], "method": {"gradient": "bspline"},
    } | changes)).bodies[0]  # fmt: skip
    return body.particles, body.source


def motion(x, name=""):
    """Velocities (Q, D) that are smooth, and their slopes (Q, D, D); those of the pipe do not leave its walls, z = 0 and 3."""
    D = x.shape[1]
    k = 0.9 * np.eye(D) + 0.4
    phase = x @ k.T + np.arange(D)
    v, L = np.sin(phase), np.cos(phase)[:, :, None] * k
    if name == "pipe":
        v[:, 1], L[:, 1] = np.sin(np.pi * x[:, 1] / 3), 0
        L[:, 1, 1] = np.pi / 3 * np.cos(np.pi * x[:, 1] / 3)
    return v, L


def power(particles, load, name=""):
    v, L = motion(particles.x, name)
    return np.sum(load.force * v) + np.einsum("pck,pdk,pcd->", load.dipole, load.F, L)


def on_face(name, traction):
    """The power of the traction on its face, by many points."""
    n = 400
    s = (np.arange(n) + 0.5) / n
    if name in ("ring", "disc"):
        R, turn, c = (0.52, -1, [1.51, 1.48]) if name == "ring" else (1.1, 1, [1.51, 1.48])
        N = turn * np.stack([np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)], axis=1)
        x, area = c + turn * R * N, 2 * np.pi * R / n * np.ones(n)
    elif name == "ball":
        z, a = (m.ravel() for m in np.meshgrid(2 * s - 1, 2 * np.pi * s))
        N = np.stack([np.sqrt(1 - z * z) * np.cos(a), np.sqrt(1 - z * z) * np.sin(a), z], axis=1)
        x, area = [1.51, 1.48, 1.53] + 1.1 * N, 4 * np.pi * 1.1**2 / n**2 * np.ones(n * n)
    elif name == "pillar":
        z, a = (m.ravel() for m in np.meshgrid(1.7 * s, 2 * np.pi * s))
        N = np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
        x, area = np.stack([1.51 + 1.1 * N[:, 0], 1.48 + 1.1 * N[:, 1], 0.3 + z], axis=1), 2 * np.pi * 1.1 * 1.7 / n**2 * np.ones(n * n)
    elif name == "pipe":
        x, N, area = np.stack([0 * s + 0.52, 3 * s], axis=1), np.tile([-1.0, 0.0], (n, 1)), 3 * 0.52 / n * np.ones(n)
    else:
        x, N, area = np.stack([0.3 + 1.33 * s, 0 * s + 2.1], axis=1), np.tile([0.0, 1.0], (n, 1)), 1.33 / n * np.ones(n)
    T = -traction["pressure"] * N if "pressure" in traction else np.tile(traction["nominal"], (len(x), 1))
    return np.sum(area[:, None] * T * motion(x, name)[0])


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("kind", ["pressure", "nominal"])
def test_power_is_that_on_the_face(name, kind):
    """Of order 2 in the cell, flat or round, whatever bounds the face; particles bear all of it at the start."""
    D = 3 if name in ("ball", "pillar") else 2
    traction = {"pressure": 0.7} if kind == "pressure" else {"nominal": [0.7, -0.4, 0.5][:D]}
    wrong = []
    for cell in (0.25, 0.125):
        particles, load = load_of(name, traction, cell)
        wrong.append(abs(power(particles, load, name) - (want := on_face(name, traction))))
        open_ = name in ("pillar", "slab") and kind == "pressure"  # beside free faces
        assert load.left == (GROWS if open_ else BORNE)
    assert wrong[1] < 0.01 * abs(want) and (wrong[1] < 0.35 * wrong[0] or wrong[1] < 1e-3 * abs(want))


@pytest.mark.parametrize("name", ["disc", "ball"])
def test_pressure_all_around_is_borne_particle_by_particle(name):
    """A body at sigma = -p, stretched and turned: what the load does at every particle is minus what its stress does, V tau = -p J V, and no force."""
    particles, load = load_of(name, {"pressure": 0.3}, 0.25)
    D = particles.x.shape[1]
    F = np.eye(D) + 0.2 * np.random.default_rng(3).normal(size=(D, D))
    load.F[:] = F
    for i in range(len(load.force)):
        turn(load.area, load, i, np.linalg.det(F), D)
    assert np.all(load.force == 0)
    assert load.dipole @ F.T == pytest.approx(-0.3 * np.linalg.det(F) * particles.V0[:, None, None] * np.eye(D), abs=1e-14)


def test_a_pressure_inside_a_ring_keeps_its_power_as_the_ring_turns_and_grows():
    """-int p G N . v dA under a uniform F: that of the face, as G f_p and G D_p."""
    F = np.array([[1.2, -0.5], [0.4, 0.9]])
    want, wrong = 0.0, []
    for cell in (0.25, 0.125):
        particles, load = load_of("ring", {"pressure": 0.7}, cell)
        load.F[:] = F
        for i in range(len(load.force)):
            turn(load.area, load, i, np.linalg.det(F), 2)
        a = 2 * np.pi * (np.arange(400) + 0.5) / 400
        N = -np.stack([np.cos(a), np.sin(a)], axis=1)
        X, area = [1.51, 1.48] - 0.52 * N, 2 * np.pi * 0.52 / 400
        want = np.sum(-0.7 * area * (N @ (np.linalg.det(F) * np.linalg.inv(F))) * motion(X @ F.T)[0])
        moved = particles._replace(x=particles.x @ F.T)
        wrong.append(abs(power(moved, load) - want))
    assert wrong[1] < 0.01 * abs(want) and (wrong[1] < 0.35 * wrong[0] or wrong[1] < 1e-3 * abs(want))


def test_a_part_of_a_round_face_is_left_at_its_pieces():
    _, load = load_of("disc", {"nominal": [0.0, -1.0]}, 0.25, loads=[{"of": "body", "side": "top", "traction": {"nominal": [0.0, -1.0]}}])
    assert load.left == ROUGH and np.count_nonzero(load.force) < len(load.force)
