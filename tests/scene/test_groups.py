"""Dimensionless groups against their definitions, and what they say at both ends of their range."""

import math

import pytest

import mpm
from mpm.scene.groups import groups, uneven
from mpm.scene.scales import scales

SLAB = {
    "grid": {"dimension": 1, "size": [3.0], "cell": 0.25},
    "bodies": {"slab": {"shape": {"box": {"lower": [0.5], "upper": [2.5]}}, "temperature": 400, "material": "m"}},
    "materials": {"m": {"density": 2.0, "heat": {"fourier": {"kappa": 4.0, "alpha": 3.0}}}},
    "surfaces": [{"of": "slab", "convection": {"beta": 0.2, "outside": 300}}],
    "time": {"end": 6.0},
}
BLOCK = {
    "grid": {"dimension": 2, "size": [3.0, 3.0], "cell": 0.25},
    "bodies": {"block": {"shape": {"box": {"lower": [0.5, 0], "upper": [2.5, 1]}}, "temperature": 300, "material": "m", "velocity": [0, -0.3]}},
    "materials": {
        "m": {
            "density": 1000,
            "elastic": {"hencky": {"lam": 4e4, "mu": 3e4}},
            "flow": {"ellipse": {"M": 2e3, "p0": 0.5, "eta": 9e4}},
            "heat": {"fourier": {"kappa": 1, "alpha": 10}},
            "expansion": {"modulus": {"gamma": 60, "reference": 290}},
            "heating": {"elastic": {}},
        }
    },
    "surfaces": [{"of": "block", "side": "top", "convection": {"beta": 10, "outside": 350}}],
    "gravity": [0, -10],
    "time": {"end": 5.0},
}


def found(config, changes=None, step=None):
    return {group.name: group for group in groups(mpm.load(config, changes), step)}


def test_biot_and_fourier_of_a_slab():
    told = found(SLAB)
    assert told["Biot"].value == pytest.approx(0.2 * 1.0 / 4.0)  # V/S is the half-thickness
    assert told["Fourier"].value == pytest.approx(4.0 * 6.0 / (2.0 * 3.0 * 1.0**2))
    assert "lumped" in told["Biot"].drop and told["Biot"].error == pytest.approx(0.05 / 2)


def test_a_held_surface_is_never_lumped():
    told = found(SLAB, {"beta": ".inf"})["Biot"]
    assert told.value == math.inf and told.drop == "" and told.error == math.inf


def test_mechanical_groups_of_a_block():
    told = found(BLOCK, step=1e-3)
    lam, mu, K, weight = 4e4, 3e4, 6e4, 1000 * 10 * 1.0
    assert told["gravity/stiffness"].value == pytest.approx(weight / (mu * (3 * lam + 2 * mu) / (lam + mu)))
    assert told["gravity/yield"].value == pytest.approx(weight / 2e3)
    assert told["impact"].value == pytest.approx(0.3 / math.sqrt((lam + 2 * mu) / 1000))
    assert told["Deborah, shear"].value == pytest.approx(9e4 / (3 * mu) / 5)
    assert told["Deborah, pressure"].value == pytest.approx(9e4 * 0.25 / K / 5)
    assert told["thermoelastic coupling"].value == pytest.approx(60**2 * 350 / (1000 * 10 * (lam + 2 * mu)))
    assert told["swelling"].value == pytest.approx(60 * 60 / (3 * K))
    assert told["Courant"].value == pytest.approx(math.sqrt((lam + 2 * mu) / 1000) * 1e-3 / 0.25)


@pytest.mark.parametrize(("lower", "upper", "walls", "lever"), [
    ([0, 1], [2, 1.2], {"left": "stick"}, 3 * 10**2),
    ([0, 1], [3, 1.2], {"left": "stick", "right": "stick"}, 15**2 / 2),
    ([0, 0], [2, 0.2], {"left": "stick"}, 1),  # on the floor
    ([0, 1], [2, 1.2], {"left": "slip"}, 1),  # held by nothing
])  # fmt: skip
def test_a_beam_bends_where_a_block_is_pressed(lower, upper, walls, lever):
    """Strain at the clamp: M c/(E I), M = w L^2/2 of a cantilever and w L^2/12 of a beam held at both ends, I = H^3/12, w = R0 g H."""
    light = {"density": 1e-2, "elastic": BLOCK["materials"]["m"]["elastic"]}
    config = BLOCK | {"surfaces": [], "walls": walls, "materials": {"m": light}}
    config["bodies"] = {"beam": {"shape": {"box": {"lower": lower, "upper": upper}}, "material": "m", "velocity": [0, -0.3]}}
    one, told = scales(mpm.load(config))["beam"], found(config)["gravity/stiffness"]
    assert one.lever == pytest.approx(lever)
    assert told.error == pytest.approx(2 * lever * told.value)
    bears = lever > 1 or lower[1] == 0
    assert bool(told.drop) == (bears and lever * told.value < 1e-3) and ("bends" in told.meaning) == (lever > 1)


@pytest.mark.parametrize(("nu", "locking", "said"), [(0.3, "fbar", "leave `locking` out"), (0.3, None, ""), (0.499, None, "locks"), (0.499, "fbar", "")])
def test_volume_locks_near_a_half_and_f_bar_costs_below(nu, locking, said):
    config = BLOCK | {"surfaces": [], "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1e5, "nu": nu}}}}}
    told = found(config, {"method.locking": locking} if locking else {}).get("Poisson")
    assert (told is None) == (not said) and (told is None or (said in told.meaning and told.value == pytest.approx(nu)))


def test_gravity_is_not_dropped_where_it_is_all_that_moves_a_body():
    config = BLOCK | {"surfaces": [], "materials": {"m": {"density": 1e-3, "elastic": BLOCK["materials"]["m"]["elastic"]}}}
    assert found(config)["gravity/stiffness"].drop == "gravity"
    assert found(config, {"bodies.block.velocity": [0, 0]})["gravity/stiffness"].drop == ""


def test_froude_of_time_scaling_grows_with_its_square():
    plain, scaled = (found(BLOCK, {"time.scale": scale})["Froude"].value for scale in (1, 10))
    assert scaled == pytest.approx(100 * plain)


def test_absent_physics_has_no_group():
    assert set(found(SLAB)) == {"Biot", "Fourier"}
    assert "Biot" not in found({**BLOCK, "surfaces": []})


def test_measures_of_round_bodies():
    body = {"shape": {"ball": {"centre": [0, 2], "radius": 1}}, "material": "m"}
    ball = {"grid": {"dimension": "axisymmetric", "size": [2, 4], "cell": 0.25}, "bodies": {"b": body}}
    one = scales(mpm.load({**SLAB, **ball, "surfaces": [{"of": "b", "convection": {"beta": 1, "outside": 350}}]}))["b"]
    assert (one.volume, one.surface) == pytest.approx((4 / 3 * math.pi, 4 * math.pi), rel=1e-6)
    assert one.length == pytest.approx(1 / 3, rel=1e-7) and one.reach == pytest.approx(1, rel=0.05)


@pytest.mark.parametrize("beta", [0.05, 0.4, 2.0])
def test_the_estimate_of_unevenness_is_above_what_a_run_shows(beta):
    experiment = mpm.load(SLAB, {"beta": beta, "time.end": 20.0})
    series = mpm.run_point(experiment).series
    assert (series["temperature_max"] - series["temperature_mean"]).max() / 100 <= uneven(scales(experiment)["slab"])
    assert (series["temperature_mean"] - series["temperature_min"]).max() / 100 <= uneven(scales(experiment)["slab"])


def test_plan_tells_the_groups():
    from mpm.sweep.plan_report import in_words, outlook

    told = outlook(mpm.load(SLAB), None, 1)
    assert [group["name"] for group in told["groups"]] == ["Biot", "Fourier"]
    assert "beta V/(S kappa): the inside keeps one temperature; could drop the inside" in in_words(told)
