"""`method.rigid: bounded`: no temperature beyond those of body and surroundings, whatever the cut, step and beta; second order all the same."""

import numpy as np
import pytest

import mpm
from mpm.heat.programmes import Sine
from mpm.materials.laws import Bump, table
from mpm.rigid import Method, RigidBody, solve
from mpm.rigid.bounded import BoundedSteps
from mpm.rigid.geometry import row_sums
from mpm.rigid.hats import hat_geometry
from mpm.scene import Ball, Box, Cylinder
from mpm.scene.build import SceneError

BOUNDED, INF = Method("bounded", tolerance=1e-3), float("inf")


def cooled(shape, space, h, origin, beta=INF, method=BOUNDED, start=400.0, outside=300.0, kappa=1.0, alpha=1.0, end=0.1, **more):
    body = RigidBody(shape, start, 1.0, kappa, alpha, (("all", beta, outside),), **more)
    return solve([body], space, h, origin, end, np.append(np.geomspace(1e-3, 1, 12) * end, end)[1:], method=method)


def keeps(run, low=300.0, high=400.0):
    """Within the data to 1e-12 of their difference, and the ledger closed to 1e-12."""
    slack = 1e-12 * (high - low)
    assert run.outcome.ok
    assert run.series["temperature.min"].min() >= low - slack and run.series["temperature.max"].max() <= high + slack
    assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()


THIN = Box((0.0, 0.0), (1.0, 0.13))  # one cell and a bit
SHAPES = [
    pytest.param(THIN, 2, id="thin box"),
    pytest.param(Box((0.0, 0.0), (1.0, 0.5), 0.4), 2, id="turned box"),
    pytest.param(Ball((0.0, 0.0), 0.5), 2, id="disc"),
    pytest.param(Cylinder(0.5, 0.4, (0.0, 0.1)), "axisymmetric", id="cylinder"),
    pytest.param(Ball((0.0, 0.0, 0.0), 0.4), 3, id="sphere"),
]


@pytest.mark.parametrize(("shape", "space"), SHAPES)
@pytest.mark.parametrize("beta", [1.0, 100.0, INF])
def test_thermal_shock(shape, space, beta):
    origin = [0.0 if space == "axisymmetric" else 0.013, 0.027, 0.041][: 3 if space == 3 else 2]
    keeps(cooled(shape, space, 0.1, origin, beta))


def test_splines_do_not_keep_them():
    """What the kind is for: of a fall of 100 K the consistent mass passes the start by 26 K and the air by 12 K, the lumped mass the air by 11 K."""
    box = Box((0.0, 0.0), (1.0, 0.5), 0.4)
    run = cooled(box, 2, 0.1, [0.013, 0.027], INF, Method("implicit"))
    assert run.series["temperature.min"].min() < 295 and run.series["temperature.max"].max() > 410
    assert cooled(box, 2, 0.1, [0.013, 0.027], 100.0, Method("explicit")).series["temperature.min"].min() < 295


def test_a_long_step_is_taken_again_by_euler():
    """The two stages of order 2 overshoot at the corner in a step of 30 h^2; backward Euler does not."""
    run = cooled(THIN, 2, 0.1, [0.013, 0.027], method=Method("bounded", step=0.3), end=0.3)
    keeps(run)
    assert run.bodies[0][1].euler > 0


@pytest.mark.parametrize("outside", [300.0, 500.0])
def test_laws_of_temperature(outside):
    """A bump in alpha and a table for kappa: the same by enthalpy."""
    alpha, kappa = Bump(1.0, 100.0, 350.0 if outside < 400 else 450.0, 2.0), table([250, 400, 550], [0.5, 1.0, 3.0])
    keeps(cooled(THIN, 2, 0.1, [0.013, 0.027], 100.0, outside=outside, alpha=alpha, kappa=kappa), *sorted([400.0, outside]))


def test_radiation_and_a_programme():
    """A sky of 280 K bounds below; surroundings that swing bound by all that they ever are."""
    keeps(cooled(THIN, 2, 0.1, [0.013, 0.027], 0.0, radiation=(("all", 1.0, 280.0),), alpha=1e-3, kappa=1e-3), 280.0, 400.0)
    keeps(cooled(THIN, 2, 0.1, [0.013, 0.027], 10.0, outside=Sine(350.0, 80.0, 0.02, 0.0)), 270.0, 430.0)


@pytest.mark.parametrize(("biot", "order", "last"), [(1.0, 1.9, 5e-5), (10.0, 1.9, 2e-4), (INF, 0.9, 7e-3)])
def test_slab_order(series, biot, order, last):
    """Worst of five offsets: order 2, and 1 behind beta = inf, where a node outside cannot be colder than the air."""

    def worst(n):
        runs = [
            solve([RigidBody(Box((-1.0,), (1.0,)), 1.0, 1.0, 1.0, 1.0, (("all", biot, 0.0),))], 1, 1 / n, o / n, 0.2, method=Method("bounded", tolerance=1e-4))
            for o in (0, 0.15, 0.3, 0.45, 0.7)
        ]
        return max(series.rms(run, lambda x: series.slab(x, 0.2, biot), lambda x: x[:, 0]) for run in runs)

    errors = [worst(n) for n in (8, 16, 32)]
    assert series.order(errors) > order and errors[-1] < last


def test_disc_order(series):
    errors = [
        series.rms(
            cooled(Ball((0.0, 0.0), 1.0), 2, 1 / n, (0.3 / n, 0.1 / n), 10.0, Method("bounded", tolerance=1e-4), 1.0, 0.0, end=0.2),
            lambda r: series.cylinder(r, 0.2, 10.0),
            lambda x: np.hypot(x[:, 0], x[:, 1]),
        )
        for n in (6, 12, 24)
    ]
    assert series.order(errors) > 1.9 and errors[-1] < 3e-4


@pytest.mark.parametrize(("shape", "space"), SHAPES)
def test_matrices(shape, space):
    """No conductance below zero, rows that sum to nothing, a linear field's Dirichlet integral exact."""
    d = shape.dimension
    made = hat_geometry(shape, space == "axisymmetric", 0.1, (0.0, *[0.02] * (d - 1)), ("all",))
    assert (made.stiffness[1:] <= 0).all() and (made.exchange[0] >= 0).all() and (made.volume >= 0).all()
    np.testing.assert_allclose(row_sums(made.stiffness, made.nodes.diff), 0, atol=1e-12)
    for a in range(d):
        row = int(np.searchsorted(made.nodes.diff, made.nodes.stride[a]))
        assert -made.stiffness[row].sum() * 0.1**2 == pytest.approx(made.w.sum(), rel=1e-12)


def test_from_a_config(core):
    """By its name in a config; `method.bounds`, which is for bodies that move, is refused with that name."""
    data = core.config(2, method={"rigid": {"bounded": {}}}, surfaces=[{"of": "body", "fixed": {"temperature": 300.0}}])
    for part in ("elastic", "expansion", "heating"):
        del data["materials"]["solid"][part]
    found = mpm.run(mpm.load(data))
    assert found.temperature_min >= 300.0 and "BoundedSteps" in str(found.attrs)
    with pytest.raises(SceneError, match=r"method\.rigid: bounded"):
        from mpm.scene.rigid import rigid_bodies

        rigid_bodies(mpm.load(data, {"method.bounds": "repair"}))


def test_kind_is_a_type():
    assert isinstance(cooled(THIN, 2, 0.1, [0.0, 0.0]).bodies[0][1], BoundedSteps)
