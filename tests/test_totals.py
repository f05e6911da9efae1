"""Totals are whole, and their units say of what: a ball is one ball in 3-D and axisymmetric; plane scenes are per metre of depth, lines per square metre."""

import math
import re

import numpy as np
import pytest

import mpm
from mpm.outcome import Run
from mpm.records.variables import PER, TOTALS, VARIABLES, describe, is_total, turn
from mpm.runner import whole

R, RHO, ALPHA, H = 4e-3, 900.0, 2000.0, 1e-3
CENTRE = {3: [6e-3] * 3, "axisymmetric": [0.0, 6e-3]}


def ball(dimension, **material):
    air = [{"of": "b", "convection": {"beta": 40, "outside": 400}}]
    return {
        "grid": {"dimension": dimension, "size": [12e-3] * len(CENTRE[dimension]), "cell": H},
        "bodies": {"b": {"shape": {"ball": {"centre": CENTRE[dimension], "radius": R}}, "temperature": 300, "material": "m"}},
        "materials": {"m": {"density": RHO, "heat": {"fourier": {"kappa": 0.4, "alpha": ALPHA}}} | material},
        "surfaces": air,
        "time": {"end": 60},
        "output": {"every": 20},
    }


def moving(dimension):
    """What a run records of the ball, thrown upwards, swollen by 1 % in each direction and 10 K warmer; no step is taken."""
    from mpm.observe import Recorder
    from mpm.scene.build import build
    from mpm.scene.scaling import shown
    from mpm.simulation import Clock

    data = ball(dimension, elastic={"hencky": {"E": 1e5, "nu": 0.3}})
    data["bodies"]["b"]["velocity"], data["gravity"] = [*([0.0] * (len(CENTRE[dimension]) - 1)), 0.5], [*([0.0] * (len(CENTRE[dimension]) - 1)), -9.81]
    experiment = mpm.load(data)
    scene = build(experiment)
    recorder, body, clock = Recorder(scene), scene.bodies[0], Clock(scene)
    body.particles.B[:, :3], body.particles.J[:], body.surface.F[:] = 1.01**2 - 1, 1.01**3, 1.01 * np.eye(len(CENTRE[dimension]))
    body.thermal.theta[:] += 10
    series = {name: np.array([value]) for name, value in (*recorder.mechanical(scene, clock), *recorder.thermal(scene, clock))}
    fields = shown(experiment)(0.0, {}, {"mass": body.particles.m, "J": body.particles.J})[2]
    return whole(Run(None, np.zeros(1), series, {}, particles=[fields]), dimension)


def test_a_ball_that_moves_is_one_ball():
    flat, full = moving("axisymmetric"), moving(3)
    volume, lam, mu, e = 4 / 3 * math.pi * R**3, 1e5 * 0.3 / (1.3 * 0.4), 1e5 / 2.6, math.log(1.01)
    stored = volume * (0.5 * lam * 9 + mu * 3) * e * e
    kinetic = 0.5 * RHO * volume * 0.5**2
    right = {
        "mass_total": RHO * volume, "volume_total": volume * 1.01**3, "heat_total": RHO * volume * ALPHA * 10, "area_exchanging": 4 * math.pi * R**2 * 1.01**2,
        "momentum_z": RHO * volume * 0.5, "energy_kinetic": kinetic, "energy_elastic": stored, "energy_total": kinetic + stored + RHO * volume * 9.81 * 6e-3,
    }  # fmt: skip
    for run in (flat, full):
        for name, value in right.items():
            assert run.series[name][0] == pytest.approx(value, rel=2e-3 if name == "area_exchanging" else 1e-5), name
        assert run.particles[0]["mass"].sum() == pytest.approx(RHO * volume, rel=1e-5) and run.particles[0]["J"] == pytest.approx(1.01**3)
    both = [name for name in flat.series if is_total(name) and name in full.series]
    assert set(right) < set(both)
    for name in set(flat.series) & set(full.series):  # means and extremes are what they were
        assert flat.series[name] == pytest.approx(full.series[name], rel=2e-3, abs=1e-12), name


def test_a_ball_at_rest_is_one_ball():
    flat, full = (mpm.run_point(mpm.load(ball(dimension))) for dimension in ("axisymmetric", 3))
    volume = 4 / 3 * math.pi * R**3
    for run in (flat, full):
        assert run.finals["heat_exchanged"] == pytest.approx(RHO * volume * ALPHA * (run.finals["temperature_mean"] - 300), rel=1e-6)
    for name in ("heat_total", "heat_exchanged"):
        assert flat.series[name] == pytest.approx(full.series[name], rel=1e-3) and flat.finals[name] == flat.series[name][-1]


@pytest.mark.parametrize(
    ("dimension", "area", "units", "of"),
    [(1, 1.0, "J/m2", ", per square metre"), (2, 0.05, "J/m", ", per metre of depth"), ("axisymmetric", math.pi * 0.03**2, "J", ""), (3, 0.05 * 0.04, "J", "")],
)
def test_the_units_say_of_what(tmp_path, dimension, area, units, of):
    """A layer that takes in 100 W/m2 from above for 60 s: 6 kJ over a square metre, over a metre of depth of its width, or over all of its face."""
    upper = {1: [0.01], 2: [0.05, 0.01], "axisymmetric": [0.03, 0.01], 3: [0.05, 0.04, 0.01]}[dimension]
    data = {
        "grid": {"dimension": dimension, "size": [0.05] * len(upper), "cell": 2e-3},
        "bodies": {"b": {"shape": {"box": {"lower": [0.0] * len(upper), "upper": upper}}, "temperature": 300, "material": "m"}},
        "materials": {"m": {"density": RHO, "heat": {"fourier": {"kappa": 0.4, "alpha": ALPHA}}}},
        "surfaces": [{"of": "b", "side": "right" if dimension == 1 else "top", "flux": {"q": 100}}],
        "time": {"end": 60},
        "output": {"every": 60},
    }
    tree = mpm.run(mpm.load(data))
    for group in (tree, tree["series"]):
        taken = group.heat_exchanged
        assert taken.attrs["units"] == units and taken.attrs["long_name"] == f"heat taken in through surfaces and given by sources since the start{of}"
    assert tree.heat_exchanged.item() == pytest.approx(6000 * area, rel=1e-9)
    assert tree["series"].temperature_mean.attrs["units"] == "K"


def test_every_total_has_units_in_every_dimension():
    from pint import UnitRegistry

    registry = UnitRegistry()

    def measured(units):
        return registry(re.sub(r"(?<=[A-Za-z])(?=\d)", "**", units.replace(" ", "*"))).dimensionality

    names = [name for name in VARIABLES if is_total(name)]
    assert {"heat_total", "mass_total", "energy_kinetic", "area_exchanging", "momentum_x", "mass"} <= set(names)
    assert all(len(units) == len(TOTALS) for units, _ in PER.values())
    for name in names:
        for dimension, per in ((1, "m2"), (2, "m"), (3, "1")):
            found, whole_units = describe(name, dimension), VARIABLES[name].units
            assert measured(found.units) == measured(f"({whole_units})/{per}"), (name, dimension)
            assert found.long_name.startswith(VARIABLES[name].long_name)
    assert turn("axisymmetric") == 2 * math.pi and {turn(d) for d in (0, 1, 2, 3)} == {1.0}
    assert describe("temperature_max", 2) == describe("temperature_max") and describe("heat_total", 0).units == "J/m3"


def test_totals_over_swept_dimensions_say_of_what(tmp_path):
    """J of an axisymmetric point and J/m of a plane one stand in one variable: its name says so."""
    from mpm.sweep.cases import plan
    from mpm.sweep.table import described, dimension_of

    box = {"b": {"shape": {"box": {"lower": [0, 0], "upper": [4e-3, 4e-3]}}, "temperature": 300, "material": "m"}}
    data = ball("axisymmetric") | {"bodies": box, "sweep": {"axes": {"grid.dimension": [2, "axisymmetric"]}}}
    assert dimension_of(plan(mpm.load(data))) is None and dimension_of(plan(mpm.load(ball(3)))) == 3
    said = ", per metre of depth where grid.dimension is 2, per square metre where it is 1"
    assert described("heat_total", ("dimension",), np.zeros(2)).attrs["long_name"].endswith(said)
    assert not described("temperature_mean", ("dimension",), np.zeros(2)).attrs["long_name"].endswith(said)
