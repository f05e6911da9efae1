"""Tractions by present area: what balances a uniform Cauchy stress, on a body of any shape that is squeezed, stretched and turned; their work; refusals."""

import math

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.integrate.traction import Present, turn
from mpm.scene.build import build
from mpm.total.forces import along, press
from mpm.total.step import force_all
from mpm.transfer import new_chunk

pytestmark = pytest.mark.plain
LAM, MU = 0.2, 0.4
SHAPES = {1: {"box": {"lower": [0.33], "upper": [1.18]}}, 2: {"polygon": {"vertices": [[0.4, 0.5], [1.3, 0.36], [1.1, 1.24], [0.71, 0.9]]}},
          "axisymmetric": {"box": {"lower": [0.27, 0.4], "upper": [1.13, 0.9]}},
          3: {"box": {"lower": [0.4, 0.44, 0.39], "upper": [0.8, 1.03, 1.18]}}}  # fmt: skip


def body(dimension, traction, frame, side="all", shape=None, **sections):
    D = {"axisymmetric": 2}.get(dimension, dimension)
    return {
        "grid": {"dimension": dimension, "size": [1.5] * D, "cell": 0.25}, "bodies": {"body": {"shape": shape or SHAPES[dimension], "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"lam": LAM, "mu": MU}}}}, "method": {"frame": frame},
        "loads": [{"of": "body", "side": side, "traction": traction}], "time": {"end": 1.0}, "output": {"every": 1.0},
    } | sections  # fmt: skip


def turned(dimension, stretch):
    """A stretch that a rotation follows, in as many directions as turn."""
    D = {"axisymmetric": 2}.get(dimension, dimension)
    F = np.eye(D)
    if dimension in (2, 3):
        c, s = math.cos(0.7), math.sin(0.7)
        F[:2, :2] = [[c, -s], [s, c]]
    if dimension == 3:
        F = F @ np.array([[1, 0, 0], [0, math.cos(0.4), -math.sin(0.4)], [0, math.sin(0.4), math.cos(0.4)]])
    return F @ np.diag(stretch)


def at_nodes(scene, F):
    """Displacements (F - 1) x on the nodes of the first body, and the chunk for a step."""
    reference, h, D = scene.references[0], scene.space.h, F.shape[0]
    shape = np.array(scene.space[1 : 1 + D])
    place = (np.stack(np.unravel_index(np.arange(len(reference.u)), shape), axis=-1) - 2) * h
    reference.u[:, :D] = place @ (F - np.eye(D)).T
    return reference, new_chunk(D, reference.f, True, False)


def unbalanced(dimension, traction, e, **given):
    """Largest force on a node in the uniform state of the principal Hencky strains e, turned; and the largest of the tractions."""
    scene = build(mpm.load(body(dimension, traction, "total", **given)))
    reference, chunk = at_nodes(scene, turned(dimension, np.exp(e[: {"axisymmetric": 2}.get(dimension, dimension)])))
    report = np.zeros(32)
    press(reference.skin, scene.space, reference, chunk, 0.0, report)
    force_all(scene.space, scene.bodies[0], reference, chunk, 0.0, report)
    D = reference.X.shape[1]
    return np.abs((reference.f[:, :D] + reference.load[:, :D])[reference.active]).max(), np.abs(reference.load[:, :D]).max()


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
@pytest.mark.parametrize("e", [-0.2, 0.15])
def test_a_pressure_all_around_balances_the_stress_of_a_squeezed_body(dimension, e):
    """sigma = -p everywhere: tau = (2 mu + n lam) e = -p J in n directions, whatever the shape and however it is turned."""
    n = {1: 1, 2: 2, "axisymmetric": 3, 3: 3}[dimension]
    p = -(2 * MU + n * LAM) * e * math.exp(-n * e)
    wrong, size = unbalanced(dimension, {"pressure": p}, [e] * 3)
    assert size > 1e-3 and wrong < 1e-11 * size


def test_a_cauchy_traction_balances_the_stress_of_a_block_pressed_flat():
    """Plane strain, free across: tau_yy = J T. Its lower face lies on a wall, its upper face is a sixth wider."""
    e = np.array([0.15, -0.15 * (LAM + 2 * MU) / LAM])
    T = (LAM * e.sum() + 2 * MU * e[1]) / math.exp(e.sum())
    shape = {"box": {"lower": [0.4, 0.0], "upper": [1.1, 0.83]}}
    block = body(2, {"cauchy": [0.0, T]}, "total", "top", shape, walls={"bottom": "slip"})
    scene = build(mpm.load(block))
    reference, chunk = at_nodes(scene, np.diag(np.exp(e)))
    report = np.zeros(32)
    press(reference.skin, scene.space, reference, chunk, 0.0, report)
    force_all(scene.space, scene.bodies[0], reference, chunk, 0.0, report)
    inside = np.setdiff1d(reference.active, reference.held[:, 0])
    assert np.abs((reference.f + reference.load)[inside, :2]).max() < 1e-11 * np.abs(reference.load).max()
    assert reference.load[:, 1].sum() == pytest.approx(T * 0.7 * math.exp(0.15))


@pytest.mark.parametrize("dimension", [2, 3])
def test_power_of_a_pressure_is_that_of_the_volume(dimension):
    """-p dV/dt, for velocities v = A x over a body that is stretched and turned already."""
    scene = build(mpm.load(body(dimension, {"pressure": 0.3}, "total")))
    F = turned(dimension, np.array([1.2, 0.9, 1.1])[:dimension])
    reference, chunk = at_nodes(scene, F)
    press(reference.skin, scene.space, reference, chunk, 0.0, np.zeros(32))
    A = np.random.default_rng(1).normal(size=F.shape)
    reference.v[:, :dimension] = (reference.u[:, :dimension] @ np.linalg.inv(F - np.eye(dimension)).T) @ (A @ F).T
    volume = np.linalg.det(F) * scene.bodies[0].particles.V0.sum()
    assert along(reference) == pytest.approx(-0.3 * volume * np.trace(A), rel=1e-10)


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", 3])
def test_forces_on_particles_turn_and_grow_with_their_surface(dimension):
    """Of the updated frame: J F^-T on what a pressure does at the pieces, |J F^-T N| on what a Cauchy traction does."""
    flat = {"box": {"lower": [0.3] * (D := {"axisymmetric": 2}.get(dimension, dimension)), "upper": [1.13] * D}}
    side, normal = ("right", [1.0]) if D == 1 else ("top", [0.0] * (D - 1) + [1.0])
    F = np.random.default_rng(2).normal(size=(D, D)) * 0.2 + np.eye(D)
    hoop = 1.1 if dimension == "axisymmetric" else 1.0
    G = np.linalg.det(F) * hoop * np.linalg.inv(F).T
    for traction, grown in (({"pressure": 0.3}, G), ({"cauchy": [0.3] * D}, np.linalg.norm(G @ normal) * np.eye(D))):
        load = build(mpm.load(body(dimension, traction, "updated", side, flat))).bodies[0].source
        area, force, dipole = load.area, load.force.copy(), load.dipole.copy()
        assert isinstance(area, Present)
        pieces, moments = area.press + area.pull, area.press_moment + area.pull_moment
        load.F[:] = F
        for i in range(len(force)):
            turn(area, load, i, np.linalg.det(F) * hoop, D)
        assert load.force - force == pytest.approx(pieces @ (grown - np.eye(D)).T, abs=1e-14)
        assert load.dipole - dipole == pytest.approx(np.einsum("ck,pkd->pcd", grown - np.eye(D), moments), abs=1e-14)
        whole = {1: 1.0, 2: 0.83, 3: 0.83**2, "axisymmetric": (1.13**2 - 0.3**2) / 2}[dimension]
        assert force.sum(axis=0) == pytest.approx(whole * (-0.3 * np.array(normal) if "pressure" in traction else np.full(D, 0.3)), rel=1e-12)


@pytest.mark.parametrize(("changes", "said"), [
    ({"loads.0.traction": {}}, "of one form.*nominal, cauchy, pressure"),
    ({"loads.0.traction": {"pressure": 1, "nominal": [1, 0]}}, "of one form, not nominal and pressure"),
    ({"loads.0.traction": {"cauchy": [1]}}, "the traction needs 2 numbers"),
])  # fmt: skip
def test_refusals(changes, said):
    with pytest.raises(ConfigError, match=said):
        mpm.load(body(2, {"pressure": 1.0}, "updated"), changes)
