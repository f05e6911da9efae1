"""What every rigid run keeps: the heat ledger, bounds, outputs at any time, crossings, snapshots, and geometry shared between points."""

import math

import numpy as np
import pytest

import mpm
from mpm.materials.laws import Bump, Logistic
from mpm.rigid import Method, RigidBody, solve
from mpm.rigid.geometry import geometry
from mpm.scene import Ball, Box, Cylinder, Polygon, Ring

SHAPES = {
    "slab": (1, Box((0.1,), (1.13,))),
    "turned box": (2, Box((0.1, 0.2), (1.2, 0.9), 0.4)),
    "ring": (2, Ring((0.0, 0.1), 0.5, 1.1)),
    "polygon": (2, Polygon(((0.0, 0.0), (1.0, 0.1), (0.7, 1.1)))),
    "cylinder": ("axisymmetric", Cylinder(0.9, 1.1, (0.0, 0.1))),
    "ball": (3, Ball((0.1, 0.2, 0.3), 0.7)),
}
METHODS = {"implicit": Method("implicit"), "order 2": Method("implicit", order=2, tolerance=1e-3), "explicit": Method("explicit")}
LAWS = {"constant": (1.3, 2.0), "bump": (1.3, Bump(2.0, 60.0, 350.0, 5.0)), "both": (Logistic(0.5, 2.0, 340.0, 20.0), Bump(2.0, 60.0, 350.0, 5.0))}


def loss(run):
    return np.abs(run.series["heat_ledger"]).max() / np.abs(run.series["heat_exchanged"]).max()


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("laws", LAWS)
def test_ledger_and_bounds(name, method, laws):
    """Hot bodies in cold air cool, cold ones warm; heat content is what came through the surface, to 1e-12 of it."""
    space, shape = SHAPES[name]
    if space == 3 and laws != "constant":
        pytest.skip("the same code as in the plane, minutes of Newton")
    kappa, alpha = LAWS[laws]
    for start, outside in ((300.0, 400.0), (400.0, 300.0)):
        body = RigidBody(shape, start, 1.5, kappa, alpha, (("all", 7.0, outside),))
        run = solve([body], space, 0.2, end=0.7, times=np.linspace(0, 0.7, 8), method=METHODS[method])
        assert run.outcome.ok
        assert loss(run) < 1e-12
        sign = np.sign(outside - start)
        assert np.all(np.diff(sign * run.series["temperature.mean"]) > 0)
        assert np.all(sign * run.series["heat_exchanged"][1:] > 0)
        assert run.series["temperature.min"].min() > 300 - 2.5
        assert run.series["temperature.max"].max() < 400 + 2.5  # splines are not monotone: 2 % where a corner is a cell wide


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("laws", ["constant", "bump"])
def test_fixed_temperature(name, laws):
    """beta = inf: the ledger holds, and the surface takes the temperature outside."""
    space, shape = SHAPES[name]
    if space == 3 and laws != "constant":
        pytest.skip("the same code as in the plane, minutes of Newton")
    kappa, alpha = LAWS[laws]
    body = RigidBody(shape, 300.0, 1.5, kappa, alpha, (("all", np.inf, 400.0),))
    run = solve([body], space, 0.2, end=4.0, times=[0.1, 4.0], method=Method(tolerance=1e-3))
    assert loss(run) < 1e-12
    _, surface = shape.cut([np.arange(0.0 if space == "axisymmetric" else -1.5, 1.6, 0.1)] * shape.dimension)
    np.testing.assert_allclose(run.sample(surface.x, 0), 400.0, atol=0.05)
    assert run.facts["heat_method"] == ["LinearSteps" if laws == "constant" else "NewtonSteps"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("laws", LAWS)
def test_insulated_or_at_equilibrium_nothing_moves(method, laws):
    kappa, alpha = LAWS[laws]
    for surfaces in ((), (("all", 0.0, 500.0),), (("all", 30.0, 333.0),)):
        body = RigidBody(Box((0.1, 0.2), (1.2, 0.9), 0.4), 333.0, 1.5, kappa, alpha, surfaces)
        run = solve([body], 2, 0.2, end=2.0, times=[0.0, 2.0], probes={"a": [0.6, 0.5]}, method=METHODS[method])
        np.testing.assert_allclose(run.series["temperature.a"], 333.0, rtol=1e-12)
        np.testing.assert_allclose(run.series["heat_exchanged"], 0.0, atol=1e-9)


@pytest.mark.parametrize("bi", [1e-6, 1e7])
@pytest.mark.parametrize("method", ["implicit", "auto"])
def test_extreme_exchange(series, bi, method):
    body = RigidBody(Box((-1.0,), (1.0,)), 1.0, 1.0, 1.0, 1.0, (("all", bi, 0.0),))
    run = solve([body], 1, 1 / 16, [0.3 / 16], end=0.3, times=[0.3], method=Method(method))
    exact = np.inf if bi > 1e6 else bi
    assert series.rms(run, lambda x: series.slab(x, 0.3, exact) if bi > 1 else np.exp(-bi * 0.3) + 0 * x, lambda x: x[:, 0]) < 1e-5
    assert loss(run) < 1e-12


def test_two_surfaces_reach_the_straight_profile():
    body = RigidBody(Box((0.0,), (1.0,)), 300.0, 1.0, 2.0, 1.0, (("left", 4.0, 400.0), ("right", np.inf, 300.0)))
    run = solve([body], 1, 0.125, [0.03], end=30.0, times=[30.0])
    flux = 100 / (1 / 4 + 1 / 2)
    x = np.linspace(0, 1, 11)
    np.testing.assert_allclose(run.sample(x[:, None]), 300 + flux / 2 * (1 - x), atol=2e-3)


def test_conductivity_of_temperature_in_steady_state():
    """Flux = int kappa/L, and Pi(theta) is straight: Kirchhoff."""
    law = Logistic(0.5, 2.0, 350.0, 10.0)

    def potential(t):
        return 0.5 * t + 1.5 * 10.0 * np.logaddexp(0, (t - 350.0) / 10.0)

    body = RigidBody(Box((0.0,), (1.0,)), 300.0, 1.0, law, 1.0, (("left", np.inf, 400.0), ("right", np.inf, 300.0)))
    for method in ("implicit", "auto"):
        run = solve([body], 1, 1 / 32, [0.01], end=20.0, times=[19.0, 20.0], method=Method(method, tolerance=1e-3))
        x = np.linspace(0.05, 0.95, 19)
        straight = potential(400.0) + (potential(300.0) - potential(400.0)) * x
        np.testing.assert_allclose(potential(run.sample(x[:, None])), straight, atol=0.2)


def test_latent_heat_is_never_jumped_over():
    """A thin plate heated through its bump in one go: heat taken in is sensible plus all latent, whatever the step."""
    alpha, width = Bump(1000.0, 2e5, 350.0, 0.5), 0.01
    body = RigidBody(Box((0.0,), (width,)), 300.0, 500.0, 0.5, alpha, (("all", 50.0, 400.0),))
    for method in (Method("explicit", tolerance=0.1), Method("implicit", tolerance=0.1), Method("implicit", order=2, tolerance=1.0)):
        run = solve([body], 1, 0.005, end=2e5, times=[2e5], method=method)
        rise = run.series["temperature.mean"][-1] - 300
        assert rise > 99
        assert run.series["heat_exchanged"][-1] == pytest.approx(500.0 * width * (1000.0 * rise + 2e5), rel=1e-6)
        assert loss(run) < 1e-12


def test_methods_agree_through_a_latent_front():
    body = RigidBody(Box((0.0,), (1.0,)), 300.0, 1.0, 1.0, Bump(1.0, 100.0, 350.0, 4.0), (("right", 20.0, 400.0),))
    times, probes = np.linspace(0, 1.5, 16), {"in": [0.3], "out": [0.95]}
    runs = [
        solve([body], 1, 1 / 24, [0.01], end=1.5, times=times, probes=probes, thresholds=[("in", 345.0)], method=Method(k, order=o, tolerance=1e-5))
        for k, o in (("explicit", 4), ("implicit", 4), ("implicit", 2))
    ]
    for run in runs[1:]:
        for name in probes:
            np.testing.assert_allclose(run.series[f"temperature.{name}"], runs[0].series[f"temperature.{name}"], atol=0.03)
        assert run.crossings["in", 345.0] == pytest.approx(runs[0].crossings["in", 345.0], rel=2e-4)


@pytest.mark.parametrize("method", ["implicit", "explicit"])
def test_outputs_do_not_change_the_run_and_crossings_come_from_dense_output(series, method):
    body = RigidBody(Box((-1.0,), (1.0,)), 1.0, 1.0, 1.0, 1.0, (("all", 2.0, 0.0),))
    levels = [("middle", 0.9), ("middle", 0.5), ("edge", 0.4), ("edge", 1.5), ("middle", 1.0)]
    probes = {"middle": [0.0], "edge": [1.0]}
    few = solve([body], 1, 1 / 32, [0.01], end=1.0, times=[1.0], probes=probes, thresholds=levels, method=Method(method, tolerance=1e-5))
    many = solve([body], 1, 1 / 32, [0.01], end=1.0, times=np.linspace(0, 1, 301), probes=probes, thresholds=levels, method=Method(method, tolerance=1e-5))
    assert few.series["temperature.edge"][-1] == pytest.approx(many.series["temperature.edge"][-1], rel=1e-13)
    assert few.crossings == pytest.approx(many.crossings, nan_ok=True)
    assert np.isnan(few.crossings["edge", 1.5])
    assert few.crossings["middle", 1.0] == 0.0
    for probe, level in levels[:3]:
        assert series.slab(np.array(probes[probe]), few.crossings[probe, level], 2.0)[0] == pytest.approx(level, abs=2e-4)
    late = many.times > 0.02
    exact = [series.slab(np.array([1.0]), t, 2.0)[0] for t in many.times[late]]
    np.testing.assert_allclose(many.series["temperature.edge"][late], exact, atol=5e-4)


def test_several_bodies_keep_their_own_heat():
    left = RigidBody(Ball((0.5, 0.5), 0.3), 300.0, 1.0, 1.0, 1.0, (("all", 5.0, 400.0),))
    right = RigidBody(Box((1.2, 0.2), (1.8, 0.8)), 350.0, 2.0, 1.0, 3.0, (("all", 2.0, 400.0),))
    probes = {"l": [0.5, 0.5], "r": [1.5, 0.5]}
    points = np.array([[0.5, 0.5], [1.0, 1.0], [1.5, 0.5]])
    both = solve([left, right], 2, 0.1, end=0.1, times=[0.0, 0.05, 0.1], probes=probes, thresholds=[("r", 352.0)], snapshots=([0.0, 0.1], points))
    alone = [solve([b], 2, 0.1, end=0.1, times=[0.0, 0.05, 0.1], probes={n: probes[n]}) for b, n in ((left, "l"), (right, "r"))]
    np.testing.assert_array_equal(both.series["temperature.l"], alone[0].series["temperature.l"])
    np.testing.assert_array_equal(both.series["temperature.r"], alone[1].series["temperature.r"])
    np.testing.assert_allclose(both.series["heat_exchanged"], alone[0].series["heat_exchanged"] + alone[1].series["heat_exchanged"])
    np.testing.assert_allclose(both.snapshots[:, [0, 2]], np.stack([both.series["temperature.l"], both.series["temperature.r"]], axis=-1)[[0, 2]])
    assert np.isnan(both.snapshots[:, 1]).all()
    assert both.series["heat"][0] == pytest.approx(0.0, abs=1e-9)  # above each body's start, as of bodies that move
    assert 0 < both.crossings["r", 352.0] < 0.1


def test_stop_gives_budget_and_what_came_before():
    body = RigidBody(Box((0.0,), (1.0,)), 1.0, 1.0, 1.0, 1.0, (("all", 1.0, 0.0),))
    run = solve([body], 1, 0.1, end=1.0, times=np.linspace(0, 1, 101), stop=lambda part, t: part > 0.3)
    assert run.outcome.kind == "budget"
    assert 20 < len(run.times) < 100
    assert len(run.series["temperature.mean"]) == len(run.times)


def test_points_of_a_sweep_share_geometry():
    geometry.cache_clear()
    for beta in (1.0, 2.0, 3.0):
        for kappa in (0.5, 1.0):
            solve([RigidBody(Ball((0.1, 0.2), 1.0), 1.0, 1.0, kappa, 1.0, (("all", beta, 0.0),))], 2, 0.3, end=0.1)
    assert geometry.cache_info().misses == 1
    assert geometry.cache_info().hits == 5


def test_surfaces_by_side():
    """Only the top exchanges: the body is a slab."""
    top = RigidBody(Box((0.13, 0.2), (0.9, 1.2)), 1.0, 1.0, 1.0, 1.0, (("top", 3.0, 0.0),))
    slab = RigidBody(Box((0.2,), (1.2,)), 1.0, 1.0, 1.0, 1.0, (("right", 3.0, 0.0),))
    a = solve([top], 2, 0.1, end=0.2, times=[0.2], probes={"p": [0.5, 1.1]})
    b = solve([slab], 1, 0.1, end=0.2, times=[0.2], probes={"p": [1.1]})
    assert a.series["temperature.p"][-1] == pytest.approx(b.series["temperature.p"][-1], abs=1e-9)
    assert a.series["heat_exchanged"][-1] == pytest.approx(0.77 * b.series["heat_exchanged"][-1], rel=1e-9)


@pytest.mark.parametrize("dimension, shape, volume", [
    (1, {"box": {"lower": [0.011], "upper": [0.043]}}, 0.032),
    (2, {"ball": {"centre": [0.03, 0.03], "radius": 0.02}}, math.pi * 0.02**2),
    ("axisymmetric", {"ball": {"centre": [0.0, 0.03], "radius": 0.02}}, 4 / 3 * math.pi * 0.02**3),
    (3, {"ball": {"centre": [0.03, 0.03, 0.03], "radius": 0.02}}, 4 / 3 * math.pi * 0.02**3),
])  # fmt: skip
def test_mass_and_volume_of_what_does_not_move(dimension, shape, volume):
    size = [0.06] * (dimension if isinstance(dimension, int) else 2)
    data = {
        "grid": {"dimension": dimension, "size": size, "cell": 0.005},
        "bodies": {"b": {"shape": shape, "material": "m", "temperature": 300}},
        "materials": {"m": {"density": 800, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
        "time": {"end": 1.0},
        "output": {"observables": ["mass.total", "volume.total"]},
    }
    run = mpm.run_point(mpm.load(data))
    assert run.finals["volume_total"] == pytest.approx(volume, rel=1e-4) and run.finals["mass_total"] == pytest.approx(800 * volume, rel=1e-4)
