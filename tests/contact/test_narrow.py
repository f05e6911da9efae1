"""A contact of a few cells is warned of where its force is largest; a face that lies flat never is."""

import numpy as np
import pytest
from contact_scenes import block, count, dropped

import mpm
from mpm.verification.hertz import force

H = 0.125


def ball(dimension, **more):
    """Of three cells a radius, that lies on the floor."""
    scene = dropped(dimension, 0.0, cells=6, E=20.0, drag=6.0, end=0.3) | more
    middle = [0.0, 3 * H] if dimension == "axisymmetric" else [5 * H] * (count(dimension) - 1) + [3 * H]
    scene["bodies"]["block"]["shape"] = {"ball": {"centre": middle, "radius": 3 * H}}
    scene["output"] = {"every": 0.1}
    return scene


def told(run):
    return [text for text in run["facts"].get("warnings", ()) if text.startswith("narrow: ")]


@pytest.mark.parametrize("dimension", [pytest.param(2, marks=pytest.mark.wide), "axisymmetric"])
def test_a_ball_on_a_floor_touches_over_few_cells(plain, dimension):
    """Its width is that of Hertz's contact to a cell; a block of two cells is not narrow."""
    on_floor, flat = plain([ball(dimension), dropped(dimension, 0.0, E=20.0, end=0.3)])
    (said,) = told(on_floor)
    assert said.startswith("narrow: block touches bottom over ") and "cells where the force is largest; smaller cells" in said
    assert not told(flat)
    force = np.abs(on_floor["series"]["force_bottom_" + ("z" if dimension == "axisymmetric" else "y")]).max()
    stiff = 20.0 / 0.91
    exact = np.sqrt(4 * force * 3 * H / (np.pi * stiff)) if dimension == 2 else np.cbrt(3 * force * 3 * H / (4 * stiff))
    assert float(said.split()[5]) == pytest.approx(2 * exact / H, abs=1.0)


def test_what_weight_presses_wide_is_not_narrow(plain):
    (run,) = plain([ball(2, gravity=[0.0, -25.0])])
    assert run["kind"] == "completed" and not told(run)


def test_two_bodies(plain):
    """One warning a pair, of the wider side."""
    scene = ball("axisymmetric")
    scene["bodies"]["block"]["shape"]["ball"]["centre"][1] = 5 * H
    scene["bodies"]["slab"] = {"shape": block("axisymmetric", 0.0, 12 * H, 0.0, 2 * H), "material": "m"}
    scene["grid"]["size"] = [7 * H, 10 * H]
    (run,) = plain([scene])
    assert run["kind"] == "completed" and len(told(run)) == 1 and told(run)[0].startswith("narrow: block touches slab over ")


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "least", "most"), [(8, -0.09, 0.12), (16, -0.05, 0.04)])
def test_the_force_over_the_approach_of_a_ball_between_plates(cells, least, most):
    """Seven approaches, at rest at each: Hertz's force with Tatara's correction, above and below in turn. Both plates bear the same."""
    approaches = np.array([0.008, 0.0125, 0.0175, 0.0225, 0.0275, 0.035, 0.045])
    ends = 35.0 * np.arange(1, 8)
    times, ways = [0.0], [0.0]
    for end, d in zip(ends, approaches, strict=True):
        times += [end - 25, end]
        ways += [-2 * d] * 2
    scene = {
        "grid": {"dimension": "axisymmetric", "size": [1.25, 2.25], "cell": 1 / cells},
        "bodies": {"ball": {"shape": {"ball": {"centre": [0, 1], "radius": 1}}, "material": "m"}},
        "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0.3}}}}, "walls": {"bottom": "contact"},
        "tools": {"plate": {"shape": {"cylinder": {"radius": 1, "height": 0.2, "base": [0, 2]}},
                            "motion": {"path": {"time": times, "displacement": [[0, way] for way in ways]}}}},
        "loads": [{"of": "ball", "drag": {"rate": 0.6}}], "time": {"end": ends[-1]}, "output": {"every": 5.0},
    }  # fmt: skip
    tree = mpm.run(mpm.load(scene))
    series = tree["series"].ds
    assert int(tree.ds.status) == 0, str(tree.ds.error.values)
    plate, floor = (series[name].interp(time=ends).values for name in ("force_plate_z", "force_bottom_z"))
    off = -plate / [force(d, 1, 0.3, 1) for d in approaches] - 1
    assert floor == pytest.approx(-plate, rel=0.02) and least < off.min() < 0 < off.max() < most
