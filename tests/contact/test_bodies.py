"""Bodies that meet: nothing passes across a gap, momentum and heat are exchanged where they touch, in the amounts that theory gives."""

import numpy as np
import pytest
from contact_scenes import bars

import mpm
from mpm.scene.build import SceneError, build

BAR = {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}


def boxes(dimension=1, size=3.0, cell=1 / 16, end=0.05, material=BAR, **bodies):
    """Bodies by name: (lower, upper, velocity, temperature)."""
    return {
        "grid": {"dimension": dimension, "size": [size] * dimension, "cell": cell},
        "bodies": {name: {"shape": {"box": {"lower": low, "upper": high}}, "material": "m", "velocity": v, "temperature": T}
                   for name, (low, high, v, T) in bodies.items()},
        "materials": {"m": material},
        "time": {"end": end},
        "output": {"every": end / 10},
    }  # fmt: skip


SOFT = {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}}


def block(x, y, vx):
    return [x * 1e-3, y * 1e-3], [(x + 2) * 1e-3, (y + 2) * 1e-3], [vx, 0.0], 300.0


def test_no_force_across_a_gap_and_none_when_parting(plain):
    """One block passes another at 0.2 cells; two that touch fly apart: no particle's velocity changes."""
    past = boxes(2, 12e-3, 1e-3, 4e-3, SOFT, a=block(2, 2, 0.5), b=block(4, 4.2, 0.0))
    part = boxes(2, 12e-3, 1e-3, 4e-3, SOFT, a=block(3, 4, -0.2), b=block(5, 4, 0.2))
    for run in plain([past, part]):
        energy = run["series"]["energy_kinetic"]
        assert run["kind"] == "completed" and np.abs(energy / energy[0] - 1).max() < 1e-10
        assert np.abs(run["series"]["strain_max"]).max() < 1e-10


def test_equal_bars_exchange_their_speeds(plain):
    """A bar thrown at an equal one stops, and the other leaves with its speed, less what a surface of 16 cells loses; momentum to rounding."""
    scene = boxes(1, 4.0, 1 / 16, 4.4, a=([0.3], [1.3], [0.01], 300), b=([1.302], [2.302], [0.0], 300))
    scene["output"]["every"] = 0.2
    (run,) = plain([scene])
    p = run["series"]["momentum_x"]
    assert run["kind"] == "completed" and np.abs(p / p[0] - 1).max() < 1e-12
    assert run["series"]["energy_total"][-1] > 0.9 * run["series"]["energy_total"][0]
    gone = run["series"]["position_max_x"]  # it rings with a period of 2 s
    assert 0.95 * 0.01 < (gone[-1] - gone[-11]) / 2.0 < 0.01


def conducting(n, alpha=1.0, kappa=1.0, **more):
    """Two slabs of half a metre at 400 and 300 K that touch in the middle; alpha and kappa of the second where given."""
    heat = {"heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}
    scene = boxes(1, 1.0, 1 / n, 0.05, BAR | heat, hot=([0.0], [0.5], [0.0], 400), cold=([0.5], [1.0], [0.0], 300))
    scene["materials"]["other"] = BAR | {"heat": {"fourier": {"kappa": kappa, "alpha": alpha}}}
    scene["bodies"]["cold"]["material"] = "other"
    scene["output"]["probes"] = {"hot": [0.25], "cold": [0.75], "face": [0.5]}
    return scene | more


def series(x, t):
    """A bar of one metre, insulated, at 400 K to its middle and 300 K from there on."""
    k = np.arange(1, 400, 2)
    return 350 + np.sum(200 / (np.pi * k) * np.sin(k * np.pi / 2) * np.cos(k * np.pi * x) * np.exp(-((k * np.pi) ** 2) * t))


def test_touching_slabs_are_one_bar_to_heat(plain):
    """Perfect contact, order 1.8 and better, the face at 350 K, and no heat lost."""
    cells = (8, 16)
    runs = plain([conducting(n) for n in cells])
    errors = [abs(run["series"]["temperature_hot"][-1] - series(0.25, 0.05)) for run in runs]
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[1] < 5e-3 * 50
    for run in runs:
        assert abs(run["series"]["heat_total"][-1]) < 1e-12 * 50
        assert abs(0.5 * (run["series"]["temperature_max"] + run["series"]["temperature_min"]) - 350).max() < 1e-9


def test_a_conductance_between_slabs(plain):
    """h_c = 5: each half is a slab that meets the middle temperature through 2 h_c."""
    from scipy.optimize import brentq

    k = [brentq(lambda m: m * np.sin(m) - 5 * np.cos(m), i * np.pi + 1e-9, i * np.pi + np.pi / 2) for i in range(50)]
    exact = 350 + 50 * sum(4 * np.sin(m) / (2 * m + np.sin(2 * m)) * np.cos(0.5 * m) * np.exp(-m * m * 0.2) for m in k)
    pair = [{"between": ["cold", "hot"], "conductance": 5}]
    errors = [abs(run["series"]["temperature_hot"][-1] - exact) for run in plain([conducting(n, contacts=pair) for n in (8, 16)])]
    assert np.log2(errors[0] / errors[1]) > 1.8 and errors[1] < 5e-3 * 50


def test_effusivities_set_the_temperature_between(plain):
    """Effusivity 1:6: the face takes (e1 400 + e2 300)/(e1 + e2) = 314.29 K at once, and keeps it while both are thick."""
    scene = conducting(16, alpha=6.0, kappa=6.0)
    scene["time"]["end"], scene["output"]["every"] = 0.01, 0.001
    (run,) = plain([scene])
    assert run["series"]["temperature_face"][-1] == pytest.approx(400 - 100 * 6 / 7, abs=2.0)
    assert abs(run["series"]["heat_total"][-1]) < 1e-10


def test_slabs_that_fly_and_slabs_that_are_welded(plain):
    """The same heat, thrown at any offset to the grid or held together; none where the pair is told so."""
    fly = conducting(16)
    fly["grid"]["size"], fly["output"]["probes"] = [3.0], {"hot": [1.05]}
    for body, low in (("hot", 0.8), ("cold", 1.3)):
        fly["bodies"][body] |= {"velocity": [3.7], "shape": {"box": {"lower": [low], "upper": [low + 0.5]}}}
    welded, apart = ([{"between": ["hot", "cold"], **how}] for how in ({"welded": {}}, {"conductance": 0}))
    flown, held, alone = plain([fly, conducting(16, contacts=welded), conducting(8, contacts=apart)])
    for run in (flown, held):
        assert run["kind"] == "completed" and run["series"]["temperature_hot"][-1] == pytest.approx(series(0.25, 0.05), abs=0.15)
    assert alone["series"]["temperature_hot"][-1] == 400.0


def refused(**changes):
    return mpm.load(conducting(16) | changes)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"method": {"transfer": {"xpic": {"order": 2}}}}, "method.transfer: xpic"),
        ({"method": {"heat": "stabilised"}}, "method.heat: hot and cold"),
        ({"bodies": boxes(hot=([0.0], [0.51], [0.0], 400), cold=([0.5], [1.0], [0.0], 300))["bodies"]}, "hot and cold overlap"),
        ({"bodies": boxes(hot=([0.0], [0.4], [0.0], 400), cold=([0.5], [1.0], [0.0], 300))["bodies"],
          "contacts": [{"between": ["hot", "cold"], "welded": {}}]}, "to be welded and lie 1.6 cells apart"),
    ],
)  # fmt: skip
def test_what_is_not_known_is_refused(changes, said):
    with pytest.raises(SceneError, match=said):
        build(refused(**changes))


@pytest.mark.parametrize(
    ("pair", "said"),
    [
        ({"between": ["hot", "warm"]}, "there is no such body"),
        ({"between": ["hot", "hot"]}, "the same body"),
        ({"between": ["hot", "cold"], "stick": {}, "friction": 0.3}, "different things of one pair"),
    ],
)
def test_pairs_are_checked(pair, said):
    with pytest.raises(mpm.ConfigError, match=said):
        refused(contacts=[pair])


def test_the_plan_says_how_bodies_meet():
    """Every pair of bodies that move, those that are not named too."""
    from mpm.scene.inventory import physics

    told = [refused(**more) for more in ({}, {"contacts": [{"between": ["cold", "hot"], "friction": 0.3, "conductance": 5}]})]
    said = [next(text for text in physics(one)["compiled"] if text.startswith("contact")) for one in told]
    assert said == ["contact: hot and cold slide and pass heat freely (not named)", "contact: hot and cold rub (0.3) and pass heat (5 W/m2K)"]


def test_corners_meet_and_exchange_nothing():
    """A box that can meet a wall has pieces of no area at its corners; air acts on its faces alone."""
    from mpm.diagnostics import exchanging_area

    scene = boxes(2, 2.0, 0.25, 1.0, BAR | {"heat": {"fourier": {"kappa": 1.0, "alpha": 1.0}}}, box=([0.5, 0.5], [1.1, 0.9], [0.3, 0.0], 400))
    scene["surfaces"] = [{"of": "box", "convection": {"beta": 5.0, "outside": 300}}]
    body = build(mpm.load(scene)).bodies[0]
    corners = np.linalg.norm(body.surface.area, axis=1) < 1e-6
    assert corners.sum() == 4 and not body.surface.beta[corners].any() and body.surface.beta[~corners].all()
    found = body.particles.x[body.surface.owner[corners]] + body.surface.offset[corners]
    assert {tuple(point) for point in np.round(found, 12)} == {(0.5, 0.5), (1.1, 0.5), (0.5, 0.9), (1.1, 0.9)}
    assert exchanging_area(body) == pytest.approx(2.0, rel=1e-12)


def test_of_one_body(plain):
    """Sums of bodies are those of all, extremes each body's own; the heat that one loses the other takes in."""
    names = [
        f"{what}.{one}" for one in ("hot", "cold") for what in ("mass.total", "heat.total", "temperature.mean", "momentum.x", "position.max_x", "velocity.max")
    ]
    scene = conducting(8, contacts=[{"between": ["hot", "cold"], "conductance": 5.0}])
    scene["output"]["observables"] = names
    scene["bodies"]["cold"]["velocity"] = [0.0]
    hurried = scene | {"time": {"end": 0.05, "scale": 4.0}}
    run, fast = plain([scene, hurried])
    s = run["series"]
    for what in ("mass_total", "heat_total", "momentum_x"):
        assert s[f"{what}_hot"] + s[f"{what}_cold"] == pytest.approx(s[what], abs=1e-12)
    assert s["heat_total_hot"] == pytest.approx(s["heat_hot_cold"], abs=1e-10) and s["heat_total_hot"][-1] < -1
    assert s["temperature_mean_hot"][0] == 400 and s["temperature_mean_cold"][0] == 300
    assert s["position_max_x_hot"][0] == pytest.approx(0.5, abs=1e-12) and s["position_max_x_cold"] == pytest.approx(s["position_max_x"], abs=0.0)
    assert fast["series"]["heat_hot_cold"][-1] == pytest.approx(s["heat_hot_cold"][-1], rel=1e-3)  # conductances are rates too


@pytest.mark.wide
def test_bodies_of_different_laws_meet_compiled():
    """Their types differ, and a loop over them is unrolled: it compiled for bodies of one type only. Momentum to rounding."""
    scene = bars(1, n=8, speed=0.05, end=2.0)
    scene["materials"]["k"]["flow"] = {"ellipse": {"M": 100.0, "p0": 20.0, "eta": 1.0}}
    tree = mpm.run(mpm.load(scene))
    series = tree["series"].ds
    assert int(tree.ds.status) == 0 and series.force_a_b_x.values.min() < -0.01
    assert np.abs(series.momentum_x.values / 0.05 - 1).max() < 1e-12
