"""Sides that a shape has of itself: inner and outer of a ring in the plane, edges of a polygon, whatever the sense of its vertices."""

import math

import numpy as np
import pytest

import mpm

RING = {
    "grid": {"dimension": 2, "size": [0.1, 0.1], "cell": 0.004},
    "bodies": {"pipe": {"shape": {"ring": {"centre": [0.05, 0.05], "inner": 0.015, "outer": 0.04}}, "material": "steel", "temperature": 350.0}},
    "materials": {"steel": {"density": 1000.0, "heat": {"fourier": {"kappa": 10.0, "alpha": 100.0}}}},
    "surfaces": [
        {"of": "pipe", "side": "inner", "convection": {"beta": 2000.0, "outside": 400.0}},
        {"of": "pipe", "side": "outer", "convection": {"beta": 2000.0, "outside": 300.0}},
    ],
    "time": {"end": 60.0},
    "output": {"every": 20.0, "probes": {"near": [0.07, 0.05], "far": [0.05, 0.0175]}},
}
# A rectangle of 20 by 10 mm, turned by atan(3/4): edge 2 of normal (0.8, 0.6), edge 4 of the opposite one, each 10 mm.
VERTICES = [[0.010, 0.008], [0.026, 0.020], [0.020, 0.028], [0.004, 0.016]]
NEAR = {"second": [0.0224, 0.0237], "fourth": [0.0076, 0.0124]}  # half a millimetre within the middles of edges 2 and 4


def plate(vertices, edge, moves=True, **more):
    steel = {"density": 1000.0, "heat": {"fourier": {"kappa": 1.0, "alpha": 100.0}}} | ({"elastic": {"hencky": {"E": 1e4, "nu": 0.3}}} if moves else {})
    return mpm.run_point(mpm.load({
        "grid": {"dimension": 2, "size": [0.04, 0.04], "cell": 0.002},
        "bodies": {"plate": {"shape": {"polygon": {"vertices": vertices}}, "material": "steel", "temperature": 300.0}},
        "materials": {"steel": steel}, "surfaces": [{"of": "plate", "side": edge, "flux": {"q": 500.0}}],
        "time": {"end": 0.006}, "output": {"every": 0.003, "probes": NEAR, "observables": ["momentum.x", "momentum.y"] if moves else []}} | more))  # fmt: skip


def test_a_pipe_between_two_fluids():
    """ln r between films: what passes by the length and radian is 100 K over the three resistances."""
    run, (a, b) = mpm.run_point(mpm.load(RING)), (0.015, 0.04)
    passed = 100 / (1 / (2000 * a) + math.log(b / a) / 10 + 1 / (2000 * b))
    for name, r in (("near", 0.02), ("far", 0.0325)):
        expected = 400 - passed * (1 / (2000 * a) + math.log(r / a) / 10)
        assert run.series[f"temperature_{name}"][-1] == pytest.approx(expected, abs=0.05)


@pytest.mark.plain
@pytest.mark.parametrize("moves", [False, True])
@pytest.mark.parametrize("turn", [1, pytest.param(-1, marks=pytest.mark.wide)])
def test_heat_through_an_edge_is_its_length_and_its_place(turn, moves):
    for edge, length, warm, cool in (("edge 2", 0.01, "second", "fourth"), ("edge 4", 0.01, "fourth", "second"), ("edge 1", 0.02, None, None)):
        run = plate(VERTICES[::turn], edge, moves)
        assert run.outcome.ok and run.series["heat_exchanged"][-1] == pytest.approx(500.0 * length * 0.006, rel=1e-9)
        if warm:
            assert run.series[f"temperature_{warm}"][-1] > 300 + 10 * (run.series[f"temperature_{cool}"][-1] - 300)


@pytest.mark.plain
@pytest.mark.parametrize("frame", ["updated", pytest.param("total", marks=pytest.mark.wide)])
@pytest.mark.parametrize("turn", [1, pytest.param(-1, marks=pytest.mark.wide)])
def test_a_traction_on_an_edge_pushes_by_its_length(turn, frame):
    for edge, length in (("edge 2", 0.01), ("edge 3", 0.02)):
        load = {"of": "plate", "side": edge, "traction": {"nominal": [3.0, -4.0]}}
        run = plate(VERTICES[::turn], edge, loads=[load], method={"frame": frame})
        assert [run.series["momentum_x"][-1], run.series["momentum_y"][-1]] == pytest.approx(np.array([3.0, -4.0]) * length * 0.006, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"surfaces.0.side": "edge 3"}, "the body has no such side .*allowed: all, left, right, bottom, top, inner, outer"),
        ({"surfaces.0.side": "outer"}, "there already, from surfaces.0"),
        ({"surfaces.0.side": "left"}, "there already, from surfaces.0"),
        ({"bodies.pipe.shape": {"polygon": {"vertices": VERTICES}}, "surfaces.0.side": "edge 5", "surfaces.1.side": "edge 4"}, "no such side.*edge 4"),
        ({"bodies.pipe.shape": {"ball": {"centre": [0.05, 0.05], "radius": 0.02}}, "surfaces.0.side": "edge 5"}, "only a polygon has edges"),
    ],
)
def test_a_side_that_is_not_there_or_is_taken_is_refused(changes, said):
    with pytest.raises(mpm.ConfigError, match=said):
        mpm.load(RING, changes)
