"""A body that comes to a wall lands on it with its face, untouched until then, whatever the offset, the kind of wall and the cell."""

import functools

import numpy as np
import pytest

H = 0.125
ARRIVALS = (0.0, 0.6, *(pytest.param(gap, marks=pytest.mark.wide) for gap in (0.3, 1.0, 2.0)))  # cells


def bar(gap, wall=None, E=1000.0, drag=30.0, **more):
    """A bar of eight cells that falls on to the left wall from `gap` cells."""
    return {
        "grid": {"dimension": 1, "size": [2.0], "cell": H},
        "bodies": {"bar": {"shape": {"box": {"lower": [gap * H], "upper": [gap * H + 1.0]}}, "material": "m"}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": E, "nu": 0.3}}}},
        "walls": {"left": wall} if wall else {},
        "gravity": [-1.0],
        "loads": [{"of": "bar", "drag": {"rate": drag}}] if drag else [],
        "time": {"end": 1.0},
        "output": {"every": 0.05},
    } | more


@pytest.mark.parametrize("gap", ARRIVALS)
def test_a_dropped_block_lands_with_its_face(plain, gap):
    """At rest its outline begins at the wall. With this drag it falls at g/30, and comes to rest within 1.5 s."""
    drag = 30.0
    (run,) = plain([bar(gap, "contact", E=1000.0, drag=drag, time={"end": 1.5 + gap * H * drag, "step": 1.2e-3}, output={"every": 0.5})])
    assert run["kind"] == "completed" and run["series"]["velocity_max"][-1] < 1e-5
    assert abs(run["series"]["position_min_x"][-1]) < 0.01 * H


def test_nothing_acts_before_touch(plain):
    """Free fall to the last step before the gap closes; then it is turned back. A wall that is not named, slip and stick are met alike from afar."""
    gap, walls = 1.4, (None, "slip", "stick", "contact")
    runs = plain([bar(gap, wall, E=100.0, drag=0.0, **{"time": {"end": 0.8}, "output": {"every": 0.02}}) for wall in walls])
    for run in runs:
        falling = 0.5 * run["times"] ** 2 < gap * H - 0.01 * H
        p = run["series"]["momentum_x"]
        assert falling.sum() > 20 and np.abs(p[falling] + run["times"][falling]).max() < 1e-10
        assert p[~falling].max() > 0.2 and np.array_equal(p, runs[0]["series"]["momentum_x"])


@pytest.mark.parametrize("cells", [((16, 0.64), (32, 0.32)), pytest.param(((16, 0.16), (32, 0.64)), marks=pytest.mark.wide)])
def test_restitution_is_one_whatever_the_cell(plain, cells):
    """A bar thrown at a wall that is not named comes back, with 0.9 and more of its speed, from any cell; its end stays before the wall, to 0.01 cells."""
    made = []
    for n, gap in cells:
        made.append(bar(0.0, gravity=[0.0], drag=0.0, **{
            "grid": {"dimension": 1, "size": [2.5], "cell": 1 / n}, "time": {"end": 4.4}, "output": {"every": 0.05},
            "bodies": {"bar": {"shape": {"box": {"lower": [gap / n], "upper": [gap / n + 1.0]}}, "material": "m", "velocity": [-0.02]}},
            "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}}}))  # fmt: skip
    for run in plain(made):
        assert run["kind"] == "completed" and run["series"]["position_min_x"].min() > -0.01 / 32
        assert 0.9 < -run["series"]["momentum_x"][-1] / run["series"]["momentum_x"][0] < 1.0 + 1e-9


def test_a_mirror_keeps_what_starts_at_it(plain):
    """Slip is bonded to the bar that starts at it: pulled away it stays, where contact lets it go."""
    held, free = plain([bar(0.0, wall, gravity=[1.0], drag=0.0, time={"end": 0.3}, output={"every": 0.3}) for wall in ("slip", "contact")])
    assert held["series"]["position_min_x"][-1] < 0.3 * H
    assert free["series"]["momentum_x"][-1] == pytest.approx(0.3, rel=1e-10)


@pytest.fixture(scope="module")
def slid(plain):
    """A block on a slope of so many degrees, with so much friction."""

    @functools.cache
    def run(slope, mu):
        scene = {
            "grid": {"dimension": 2, "size": [2.0, 1.0], "cell": 0.25},
            "bodies": {"block": {"shape": {"box": {"lower": [0.5, 0.0], "upper": [1.25, 0.5]}}, "material": "m"}},
            "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 400.0, "nu": 0.2}}}},
            "walls": {"bottom": {"contact": {"friction": mu}}},
            "gravity": [np.sin(np.radians(slope)), -np.cos(np.radians(slope))],
            "time": {"end": 0.8},
            "output": {"every": 0.1},
        }
        return plain([scene])[0]

    return run


@pytest.mark.parametrize(("slope", "mu"), [(30.0, 0.2), *(pytest.param(20.0, mu, marks=pytest.mark.wide) for mu in (0.0, 0.6))])
def test_a_block_on_an_incline(slid, slope, mu):
    """It slides with g (sin - mu cos), or stays where that is negative. It rings on its normal force, so: p_x + mu p_y = m g (sin - mu cos) t."""
    s, c, run = np.sin(np.radians(slope)), np.cos(np.radians(slope)), slid(slope, mu)
    p, q, mass = (run["series"][name] for name in ("momentum_x", "momentum_y", "mass_total"))
    assert run["kind"] == "completed"
    if s < mu * c:
        assert abs(p[-1]) < 0.01 * mass[0] * s * run["times"][-1]
    else:
        found = (p + mu * q)[4:] / mass[0] / run["times"][4:]
        assert found == pytest.approx(s - mu * c, rel=0.005)


def test_what_friction_takes_is_in_the_books(slid):
    """Down 30 degrees with mu = 0.2: mu times the normal impulse times the way, to 2 %; next to nothing is unaccounted for."""
    s = slid(30.0, 0.2)["series"]
    way = s["position_mean_x"] - s["position_mean_x"][0]
    taken = 0.2 * np.cos(np.radians(30)) * s["mass_total"] * way
    assert way[-1] == pytest.approx(0.5 * (0.5 - 0.2 * np.cos(np.radians(30))) * 0.64, rel=0.02)
    assert s["dissipation_friction"][-1] == pytest.approx(taken[-1], rel=0.02)
    assert abs(s["dissipation_transfer"][-1]) < 0.02 * s["energy_kinetic"][-1]


def test_a_landed_block_takes_in_heat_as_one_that_starts_there(plain):
    """Through a wall with beta, from a cell above it: as much as from the start on, less what the fall takes."""
    hot = {"contact": {"heat": {"beta": 50.0, "temperature": 400}}}
    material = {"density": 1.0, "elastic": {"hencky": {"E": 1000.0, "nu": 0.3}}, "heat": {"fourier": {"kappa": 10.0, "alpha": 100.0}}}
    scenes = [bar(gap, hot, materials={"m": material}, gravity=[-30.0], time={"end": 1.2}, output={"every": 0.04}) for gap in (0.0, 1.0)]
    started, landed = plain(scenes)
    q, p = started["series"]["heat_exchanged"], landed["series"]["heat_exchanged"]
    fall = landed["times"][np.flatnonzero(p)[0] - 1]
    assert 0.1 < fall < 0.2  # at the speed that a drag of 30/s leaves it
    later = np.interp(started["times"][-1] - fall, started["times"], q)
    sooner = np.interp(started["times"][-1] - fall - 0.04, started["times"], q)
    assert sooner < p[-1] < 1.01 * later
    assert np.abs(landed["series"]["heat_ledger"]).max() < 1e-12 * np.abs(p).max() + 1e-12
