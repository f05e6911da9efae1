"""Tractions and drag: force and moment of the pieces, the static answer at finite strain, free motion that dies out, and refusals."""

import math

import numpy as np
import pytest

import mpm
from mpm.config import ConfigError
from mpm.heat.programmes import at
from mpm.integrate.traction import risen
from mpm.scene.build import build
from mpm.scene.exchange import programme
from mpm.scene.refusal import SceneError
from mpm.sources import acting
from mpm.state import Load, NoSource, Ramp

pytestmark = pytest.mark.plain


def scene(core, dimension, loads, **sections):
    data = core.config(dimension, surfaces=[], loads=loads, **sections)
    for part in ("heat", "expansion", "heating"):
        del data["materials"]["solid"][part]
    return mpm.load(data)


@pytest.mark.parametrize("gradient", ["mls", "bspline"])
@pytest.mark.parametrize(("dimension", "side", "area", "centre"), [
    (1, "right", 1.0, [1.35]), (2, "right", 0.75, [1.35, 0.975]), (2, "all", 0.0, None),
    (3, "top", 0.75**2, [0.975, 0.975, 1.35]), ("axisymmetric", "top", 0.85**2 / 2, [2 * 0.85 / 3, 1.35]),
])  # fmt: skip
def test_force_and_moment(core, dimension, side, area, centre, gradient):
    """Sum of forces is T A; sum of f x_p + dipole is T A x of the face's centre, wherever the face lies in its cells."""
    T = np.array([2.0, -3.0, 0.5])[: core.DIRECTIONS[dimension]]
    (body,) = build(scene(core, dimension, [{"of": "body", "side": side, "traction": {"nominal": T.tolist()}}], method={"gradient": gradient})).bodies
    load = body.source
    if side == "all":  # a traction in one direction all round is no net load per normal, but T on the whole surface
        assert load.force.sum(axis=0) == pytest.approx(T * 3.0, rel=1e-12)
        return
    assert load.force.sum(axis=0) == pytest.approx(T * area, rel=1e-12)
    moment = np.einsum("pc,pd->cd", load.force, body.particles.x) + load.dipole.sum(axis=0)
    assert moment == pytest.approx(np.outer(T * area, centre), rel=1e-12)
    assert load.loaded.sum() < len(load.t) and load.scale == (pytest.approx(4 / 0.25**2) if gradient == "mls" else 1.0)


@pytest.mark.parametrize("frame", ["updated", "total"])
def test_gravity_sets_in_as_loads_do(core, frame):
    """`interpolation: smooth`: the share of a load's ramp, and a fall of g T (s^3 - s^4/2)."""
    g, T = -0.3, 0.8
    falling = scene(core, 1, [], gravity=[{"table": {"time": [0, T], "value": [0, g], "interpolation": "smooth"}}], time={"end": 0.6, "step": 0.01},
                    output={"every": 0.3}, method={"frame": frame})  # fmt: skip
    law = programme(falling.gravity[0])
    assert [at(law, t) for t in (0.0, 0.2, 0.5, 0.8, 2.0)] == pytest.approx([g * risen(t, T) for t in (0.0, 0.2, 0.5, 0.8, 2.0)], abs=1e-16)
    _, run = core.play(falling)
    s = run.series["momentum_x"] / run.finals["mass_total"]
    assert s == pytest.approx([g * T * (u**3 - u**4 / 2) for u in (0.0, 0.375, 0.75)], abs=2e-5)


@pytest.mark.parametrize("T", [0.08, -0.12])
def test_static_bar_at_finite_strain(core, T):
    """Pulled or pressed on its end, the bar rests where P = M ln F/F = T, F by bisection: log strains of 0.087 and -0.108, its end anywhere in a cell."""
    experiment = mpm.load(core.config(
        1, grid={"dimension": 1, "size": [2.0], "cell": 0.0625}, bodies={"body": {"shape": {"box": {"lower": [0], "upper": [1.07]}}, "material": "solid"}},
        materials={"solid": {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}}, surfaces=[],
        loads=[{"of": "body", "side": "right", "traction": {"nominal": [T], "ramp": 8.0}}, {"of": "body", "drag": {"rate": 3.0}}],
        time={"end": 24.0}, output={"every": 12.0}, method={"particles": 4},
    ))  # fmt: skip
    start = build(experiment).bodies[0].particles.x[:, 0]
    end, run = core.play(experiment)
    low, high = 0.5, math.e
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if math.log(middle) / middle < T else (low, middle)
    assert run.outcome.ok
    assert run.series["position_mean_x"][-1] - 1.07 / 2 == pytest.approx(1.07 / 2 * (low - 1), rel=3e-3)
    assert np.log(end.bodies[0].particles.J[start < 0.6]) == pytest.approx(math.log(low), rel=6e-3)
    stored = 1.07 * math.log(low) ** 2 / 2  # what is left of the work of traction and drag once all is at rest
    assert run.finals["work_loads"] == pytest.approx(stored, rel=1.2e-2)  # twice the tolerance of the strain
    assert abs(run.finals["dissipation_transfer"]) < 1e-2 * stored and run.finals["energy_ledger"] == -run.finals["dissipation_transfer"]


def test_drag_alone_slows_by_its_rate(core):
    """A body in free flight: v = v0 (1 - rate dt/2) (1 - rate dt)^(n - 1) half a step before the end, exp(-rate t) to the first order in the step."""
    experiment = scene(core, 1, [{"of": "body", "drag": {"rate": 2.0}}], time={"end": 0.5, "step": 1e-3}, output={"every": 0.5})
    experiment.bodies["body"].__dict__["velocity"] = (0.1,)
    end, run = core.play(experiment)
    assert run.outcome.ok and run.steps == 500
    assert end.bodies[0].particles.v == pytest.approx(0.1 * (1 - 1e-3) * (1 - 2e-3) ** 499, rel=1e-9)


def test_ramp():
    assert [risen(t, 2.0) for t in (0.0, 0.5, 1.0, 2.0, 3.0)] == [0.0, 0.15625, 0.5, 1.0, 1.0] and risen(0.0, 0.0) == 1.0


def test_time_scaling_hurries_loads(core):
    experiment = scene(core, 1, [{"of": "body", "side": "right", "traction": {"nominal": [1.0], "ramp": 4.0}}, {"of": "body", "drag": {"rate": 3.0}}],
                       time={"end": 8.0, "scale": 10.0})  # fmt: skip
    load = build(experiment).bodies[0].source
    assert (load.ramp.time, load.rate, load.force.sum()) == (pytest.approx(0.4), pytest.approx(30.0), pytest.approx(1.0))


def test_absence(core):
    assert type(build(scene(core, 1, [])).bodies[0].source) is NoSource
    assert type(build(scene(core, 1, [{"of": "body", "drag": {"rate": 1}}])).bodies[0].source) is Load


@pytest.mark.parametrize(
    ("load", "words"),
    [
        ({"of": "bdy", "drag": {"rate": 1}}, "no such body"),
        ({"of": "body"}, "does not say what acts"),
        ({"of": "body", "side": "top", "traction": {"nominal": [1]}}, "no such side in dimension 1"),
        ({"of": "body", "traction": {"nominal": [1, 2]}}, "the traction needs 1 number"),
        ({"of": "body", "traction": {"nominal": ["1 m"]}}, "Pa"),
        ({"of": "body", "drag": {"rate": -1}}, "out of range"),
    ],
)
def test_refusals(core, load, words):
    with pytest.raises(ConfigError, match=words):
        scene(core, 1, [load])


def test_a_point_and_a_rigid_body_are_not_loaded(core):
    data = core.config(1, loads=[{"of": "body", "drag": {"rate": 1}}])
    for part in ("elastic", "expansion", "heating"):
        del data["materials"]["solid"][part]
    with pytest.raises(ConfigError, match="cannot move"):
        mpm.load(data)


def test_two_ramps(core):
    """Two loads, each with its own; in the total frame they are refused."""
    loads = [{"of": "body", "side": side, "traction": {"nominal": [1.0], "ramp": ramp}} for side, ramp in (("left", 1.0), ("right", 2.0))]
    both = acting(build(scene(core, 1, loads)).bodies[0].source)
    assert [one.ramp for one in both] == [Ramp(1.0), Ramp(2.0)] and all(one.force.sum() == pytest.approx(1.0) for one in both)
    with pytest.raises(SceneError, match="ramps of 1 s, 2 s"):
        build(scene(core, 1, loads, method={"frame": "total"}))


@pytest.mark.parametrize("cells", [8, 16])
def test_stress_under_a_traction_in_the_last_cells(core, cells):
    """A bar at rest under 1e-4 of its modulus, its end anywhere in a cell: every particle bears it within 0.2 %, those under the load too."""
    experiment = mpm.load(core.config(
        1, grid={"dimension": 1, "size": [1.5], "cell": 1 / cells}, bodies={"body": {"shape": {"box": {"lower": [0], "upper": [1.02]}}, "material": "solid"}},
        materials={"solid": {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}}, surfaces=[],
        loads=[{"of": "body", "side": "right", "traction": {"nominal": [1e-4], "ramp": 5.0}}, {"of": "body", "drag": {"rate": 2.0}}],
        time={"end": 40.0}, output={"every": 20.0},
    ))  # fmt: skip
    end, run = core.play(experiment)
    assert run.outcome.ok
    assert np.log(end.bodies[0].particles.J) == pytest.approx(1e-4, rel=2e-3)
