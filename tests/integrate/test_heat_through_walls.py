"""Heat through a side that lies on a wall: whatever the wall is for motion, for heat it is a free surface, of order 2 in every scheme, law and dimension.

A slab of thickness 1 between its wall and an insulated face, Bi = 10, Fo = 0.1; the mean is that of the series (tests/reference/heat_robin.csv).
With the temperature mirrored at the wall it was 5.0, 2.5, 1.2 % too much at 16, 32, 64 cells.
"""

import numpy as np
import pytest

HERE = {1: "left", 2: "bottom", "axisymmetric": "bottom", 3: "bottom"}  # the side of the last direction
CONSTANT, LAW = 1.5, {"table": {"temperature": [1.0, 1000.0], "value": [1.5, 1.5]}}  # the same alpha, as a number and by the path of enthalpies
ALL = [(heat, alpha) for heat in ("explicit", "stabilised", "implicit") for alpha in (CONSTANT, LAW)]
slow = pytest.mark.slow


def lost(core, n, dimension=1, wall="stick", heat="stabilised", alpha=CONSTANT, act="convection", upper=False, transfer="apic"):
    """Relative error of the fall of the mean; n cells across the slab, two beside it."""
    D, h, side = core.DIRECTIONS[dimension], 1 / n, HERE[dimension]
    air = {"beta": 30.0, "outside": core.COLD}
    size, lower, top = [2 * h] * (D - 1) + [1.5], [0.0] * D, [2 * h] * (D - 1) + [1.0]
    if upper:
        side = {"left": "right", "bottom": "top"}[side]
        lower[-1], top[-1] = 0.5, 1.5
    kind, surfaces = {wall: {}}, [{"of": "body", "side": side, "convection": air}]
    if act == "hot wall":
        kind, surfaces = {wall: {"heat": {"beta": 30.0, "temperature": core.COLD}}}, []
    run = core.play(core.experiment(
        dimension, {"kappa": 3.0, "time.end": 0.1, "output.every": 0.1}, grid={"dimension": dimension, "size": size, "cell": h}, walls={side: kind},
        bodies={"body": {"shape": {"box": {"lower": lower, "upper": top}}, "temperature": core.HOT, "material": "solid"}}, surfaces=surfaces,
        materials={"solid": core.config()["materials"]["solid"] | {"heat": {"fourier": {"kappa": 3.0, "alpha": alpha}}}},
        method=core.methods(transfer) | {"heat": heat},
    ))[1]  # fmt: skip
    assert run.outcome.ok and np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
    (row,) = (row for row in core.table("heat_robin.csv") if (row["geometry"], row["Bi"], row["Fo"]) == ("slab", 10, 0.1))
    return (core.HOT - run.finals["temperature_mean"]) / ((core.HOT - core.COLD) * (1 - row["theta_mean"])) - 1


@pytest.mark.parametrize(("heat", "alpha"), [pytest.param(*one, marks=[] if one == ALL[2] else pytest.mark.wide if one == ALL[5] else slow) for one in ALL])
@pytest.mark.parametrize("wall", ["slip", "stick"])
def test_order_2_in_every_scheme(core, heat, alpha, wall):
    errors = [abs(lost(core, n, wall=wall, heat=heat, alpha=alpha)) for n in (16, 32)]
    assert errors[0] < 5e-3 and errors[1] < 1.3e-3 and core.order(errors) > 1.8, errors


@pytest.mark.parametrize("dimension", [2, pytest.param("axisymmetric", marks=slow), pytest.param(3, marks=slow)])
def test_every_dimension_is_as_a_line(core, dimension):
    """A strip between insulated slip walls is the slab in 1-D."""
    assert lost(core, 8, dimension) == pytest.approx(lost(core, 8), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, "axisymmetric", 3])
@pytest.mark.parametrize(("heat", "alpha"), ALL)
def test_every_dimension_and_scheme_is_as_a_line(core, dimension, heat, alpha):
    assert lost(core, 8, dimension, "slip", heat, alpha) == pytest.approx(lost(core, 8, 1, "slip", heat, alpha), abs=1e-8)


@pytest.mark.plain
def test_hot_walls_and_upper_walls(core):
    """What a wall exchanges itself is what a side that lies on it does, and up is as down."""
    one = lost(core, 8)
    assert lost(core, 8, act="hot wall") == pytest.approx(one, abs=1e-12)
    assert lost(core, 8, upper=True) == pytest.approx(one, abs=1e-9)
    assert lost(core, 8, wall="contact") == one


@pytest.mark.slow
@pytest.mark.parametrize("transfer", ["flip blend", "pic"])
def test_other_transfers_are_as_at_a_contact_wall(core, transfer):
    assert lost(core, 16, transfer=transfer) == lost(core, 16, wall="contact", transfer=transfer)


def test_an_insulated_mirror_stays_one(core):
    """Half a slab that exchanges on the other side only: the wall is the plane of symmetry, with the same bits as before there were free ones."""
    from mpm.scene.build import build

    air = [{"of": "body", "side": "right", "convection": {"beta": 30.0, "outside": core.COLD}}]
    bodies = {"body": {"shape": {"box": {"lower": [0.0], "upper": [1.0]}}, "temperature": core.HOT, "material": "solid"}}
    scene = build(core.experiment(1, walls={"left": "slip", "right": "stick"}, bodies=bodies, surfaces=air))
    around, body = scene.surroundings[0], scene.bodies[0]
    assert np.array_equal(around.mirrors(scene.space, body, scene.walls), scene.walls)
    body.particles.x[:] += 1.0  # on to the other wall
    free = scene.walls.copy()
    free[0, 1] = 2
    assert np.array_equal(around.mirrors(scene.space, body, scene.walls), free)
