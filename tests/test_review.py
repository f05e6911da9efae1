"""Every kind of warning that a run's records give rise to: a scene that must raise it, and a sibling that must not."""

import math
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import erfcx

import mpm
from mpm.config.rules_mechanics import named
from mpm.review import LOOKS, review
from mpm.warned import KINDS, kinds

SOLID = {"density": 2.0, "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}}, "flow": {"ellipse": {"M": 9.0, "p0": 9.0, "eta": 1.0}},
         "heat": {"fourier": {"kappa": 0.1, "alpha": 1.5}}}  # fmt: skip
WARM = {"temperature": 300.0}


def scene(lower, upper, walls=("left",), soft=False, **changes):
    """A bar in one direction on a wall at its left, in cells of 0.25."""
    solid = SOLID | ({"flow": {"ellipse": {"M": 0.01, "p0": 0.3, "eta": 1.0}}} if soft else {})
    data = {
        "grid": {"dimension": 1, "size": [7.0], "cell": 0.25},
        "bodies": {"bar": {"shape": {"box": {"lower": [lower], "upper": [upper]}}, "velocity": [changes.pop("speed", 0.0)], "material": "solid"} | WARM},
        "materials": {"solid": solid}, "walls": {side: {"stick": {}} for side in walls}, "gravity": [changes.pop("gravity", 0.0)],
        "time": {"end": 2.0}, "output": {"every": 0.1, "probes": {"tip": [upper - 0.05]}},
    }  # fmt: skip
    return mpm.load(data | changes)


PAIRS = {  # kind: (raises it, does not)
    "volume": ({"soft": True, "gravity": -0.05, "time": {"end": 10.0}}, {"gravity": -0.05, "time": {"end": 10.0}}),
    "energy": ({"lower": 0.5, "upper": 1.25, "speed": -0.8, "time": {"end": 6.0}}, {"lower": 0.5, "upper": 1.25, "speed": 0.8, "time": {"end": 6.0}}),
    "thin": ({"lower": 1.0, "upper": 1.3}, {"lower": 1.0, "upper": 1.6}),
    "edge": ({"lower": 5.0, "upper": 6.7, "speed": 0.1}, {"lower": 5.0, "upper": 6.7, "speed": 0.1, "walls": ("left", "right")}),
    "step": ({"time": {"end": 2.0, "step": 0.015}, "output": {"every": 0.02}}, {"time": {"end": 2.0, "step": 0.01}, "output": {"every": 0.02}}),
}


@pytest.mark.plain
@pytest.mark.parametrize("kind", PAIRS)
def test_a_scene_raises_it_and_its_sibling_does_not(kind):
    raised, quiet = (mpm.run_point(scene(**{"lower": 0.0, "upper": 4.0} | more)) for more in PAIRS[kind])
    assert raised.outcome.ok and quiet.outcome.ok
    assert kind in kinds(raised.facts["warnings"]) and kind not in kinds(quiet.facts["warnings"])
    assert any(KINDS[kind] in text for text in raised.facts["warnings"])


def planted(core, experiment, spoil):
    """Kinds of the warnings of a run whose scene is spoilt half way."""
    kept, done = [], []

    def beat(_, now):
        if now > 0.5 * experiment.time.end and not done:
            done.append(spoil(kept[0].bodies[0]))
        return False

    run = core.play(experiment, kept.append, beat)[1]
    assert run.outcome.ok and done
    return kinds(review(experiment, run))


def test_heat_that_the_ledger_misses(core):
    """A kelvin that nobody took."""
    experiment = core.experiment(1, {"outside": core.COLD, "kappa": 2.0})
    assert planted(core, experiment, lambda body: body.thermal.theta.__isub__(1.0)) == ("heat",)
    assert planted(core, experiment, lambda body: None) == ()


@pytest.mark.parametrize(("most", "off", "told"), [(310.0, 1e-13, False), (310.0, 0.5, True), (300.0, 1e-13, False), (300.0, 0.5, True)])
def test_round_off_of_a_scene_that_takes_in_no_heat_is_no_gap(most, off, told):
    """Two bodies that only pass heat to each other: the ledger is measured by what evens out, not by the nothing that is exchanged; of one temperature too."""
    series = {"temperature_min": [300.0], "temperature_max": [most], "mass_total": [2.0], "heat_total": [off], "heat_exchanged": [0.0], "heat_ledger": [off]}
    run = SimpleNamespace(series={name: np.array(values) for name, values in series.items()}, facts={})
    assert bool(list(LOOKS["heat"](scene(0.0, 4.0), run))) is told  # 1 % of 2 kg times 1.5 J/(kg K) times 10 K


def test_round_off_of_heat_that_adds_up_to_nothing_is_no_gap():
    """A square of temperatures that cancel: heat content and heat given are both round-off, 1e-15 J/m; rigid bodies record no mass unless asked."""
    path = Path(__file__).parents[1] / "configs/verification/posed_heat.yaml"
    run = mpm.run_point(mpm.load(path, {"grid.cell": 0.25}))
    assert np.abs(run.series["heat_total"]).max() < 1e-13 and "mass_total" not in run.series and run.facts.get("warnings", []) == []


@pytest.mark.parametrize(("held", "told"), [(1e-36, False), (1e-26, False), (1e-20, True), (1.0, True)])
def test_the_round_off_of_a_body_at_rest_is_no_energy(held, told):
    """A bar of 4 m3 and lam + 2 mu = 7 holds 7e-23 J at a strain of 1e4 round-offs."""
    series = {"energy_kinetic": held, "energy_elastic": 0.0, "dissipation_total": 0.0, "work_loads": 0.0, "dissipation_transfer": -held, "volume_total": 4.0}
    run = SimpleNamespace(series={name: np.array([value]) for name, value in series.items()}, facts={})
    assert bool(list(LOOKS["energy"](scene(0.0, 4.0), run))) is told


@pytest.mark.parametrize(
    ("transfer", "steps", "told"), [("pic", 100, True), ("pic", 1, False), ({"flip": {"blend": 0.5}}, 100, True), ("flip", 100, False), ("apic", 100, False),
                                    ({"xpic": {"order": 1}}, 100, True), ("xpic", 100, False)]
)  # fmt: skip
def test_what_conducts_by_itself_is_told(transfer, steps, told):
    """PIC adds R0 alpha h^2/(4 dt): 2.3 to a kappa of 3 in steps of 0.02 s, 0.02 in one of 2 s, and nothing where all is at one temperature."""
    series = {"temperature_min": [300.0], "temperature_max": [350.0], "heat_total": [1.0], "heat_exchanged": [1.0], "heat_ledger": [0.0]}
    run = SimpleNamespace(series={name: np.array(values) for name, values in series.items()}, facts={"heat_steps": steps})
    materials = {"solid": SOLID | {"heat": {"fourier": {"kappa": 3.0, "alpha": 1.5}}}}
    found = list(LOOKS["heat"](scene(0.0, 4.0, method={"temperature": transfer}, materials=materials), run))
    assert [("conducts 2.3 W" in text or "conducts 1.2 W" in text) for text in found] == [True] * told
    run.series["temperature_max"] = run.series["temperature_min"]
    assert not list(LOOKS["heat"](scene(0.0, 4.0, method={"temperature": transfer}, materials=materials), run))


@pytest.mark.parametrize(("passed", "conductance", "told"), [(0.0, None, []), (2.0, None, ["a", "b"]), (2.0, 1e-6, []), (-2.0, 5.0, ["a", "b"])])
def test_depth_of_what_passes_between_bodies(passed, conductance, told):
    """Heat that reaches less than a cell deep into the body that is touched; not where the contact and not the body resists."""
    heat = {"heat": {"fourier": {"kappa": 1e-3, "alpha": 1.5}}}
    bodies = {
        name: {"shape": {"box": {"lower": [low], "upper": [low + 2]}}, "temperature": T, "material": "solid"} for name, low, T in (("a", 1, 300), ("b", 3, 350))
    }
    contacts = [{"between": ["a", "b"], "conductance": conductance}] if conductance else []
    experiment = scene(0.0, 4.0, bodies=bodies, contacts=contacts, materials={"solid": SOLID | heat}, output={"every": 0.1})
    run = SimpleNamespace(series={"heat_a_b": np.array([0.0, passed])})
    assert [text.split()[5].rstrip(",") for text in LOOKS["depth"](experiment, run)] == told


@pytest.mark.parametrize(
    ("changes", "where"), [({"surfaces": [{"of": "bar", "from": 2.0, "flux": {"q": 1.0}}]}, "surfaces.0"),
                           ({"sources": [{"of": "bar", "from": 3.0, "heat": 1.0}]}, "sources.0"),
                           ({"tools": {"press": {"from": 2.5, "shape": {"box": {"lower": [5.0], "upper": [6.0]}}}}}, "tools.press"),
                           ({"surfaces": [{"of": "bar", "from": 1.9, "flux": {"q": 1.0}}]}, None)]
)  # fmt: skip
def test_what_begins_after_the_end_is_told(changes, where):
    found = list(LOOKS["late"](scene(0.0, 4.0, **changes), None))
    assert [text.split()[0] for text in found] == ([where] if where else [])


@pytest.mark.plain
def test_a_stage_of_loading_after_the_end_is_told():
    stages = [{"strain_rate": {"zz": 0.01}, "until": 5}, {"until": 8}, {"strain_rate": {"zz": -0.01}}]
    point, matter = {"shape": "point", "material": "m"}, {"density": 1, "elastic": {"hencky": {"E": 1, "nu": 0}}}
    run = mpm.run_point(mpm.load(
        {"grid": {"dimension": 0}, "bodies": {"p": point}, "materials": {"m": matter}, "loading": stages, "time": {"end": 6}}))  # fmt: skip
    assert [text.split()[1] for text in run.facts["warnings"]] == ["loading.2"]


@pytest.mark.parametrize("kappa", [0.05, 5e-3, 2e-3, 5e-4, 1e-5, 1e-30])
def test_heat_that_reaches_less_than_a_quarter_of_a_cell_is_told(kappa):
    """A slab of ten cells, beta = 50, 80 K, 60 s, against the half space: what is off by more than a tenth has a warning, what is within 3 % has none."""
    solid = {"density": 1000.0, "heat": {"fourier": {"kappa": kappa, "alpha": 2000.0}}}
    data = {
        "grid": {"dimension": 1, "size": [0.02], "cell": 0.001}, "time": {"end": 60.0}, "output": {"every": 10.0, "observables": ["heat.exchanged"]},
        "bodies": {"s": {"shape": {"box": {"lower": [0.005], "upper": [0.015]}}, "temperature": 293.15, "material": "d"}}, "materials": {"d": solid},
        "surfaces": [{"of": "s", "convection": {"beta": 50.0, "outside": 373.15}}],
    }  # fmt: skip
    run = mpm.run_point(mpm.load(data))
    D = kappa / 2e6
    H = 50.0 * np.sqrt(60.0 * D) / kappa
    exact = 2 * 80.0 * kappa**2 / (50.0 * D) * (erfcx(H) - 1 + 2 * H / np.sqrt(np.pi))  # Carslaw & Jaeger 2.7: the heat that passed by a time
    off = abs(run.finals["heat_exchanged"] / exact - 1)
    assert run.outcome.ok and (off > 0.1 or off < 0.03) and ("depth" in kinds(run.facts["warnings"])) == (kappa <= 2e-3)
    assert (off > 0.1) == (kappa <= 5e-4)


@pytest.mark.parametrize("kappa", [0.05, 1e-2, 1e-3, 1e-4, 1e-9, 0.0])
def test_a_flux_that_stays_within_a_layer_of_a_cell_is_told(kappa):
    """The face of a half space is 2 q sqrt(t/(pi kappa rho alpha)) warmer (Carslaw & Jaeger 2.9): what is off by more than 3 % has a warning."""
    data = {
        "grid": {"dimension": 1, "size": [0.02], "cell": 0.001}, "time": {"end": 60.0}, "output": {"every": 10.0, "observables": ["temperature.max"]},
        "bodies": {"s": {"shape": {"box": {"lower": [0.005], "upper": [0.015]}}, "temperature": 293.15, "material": "d"}},
        "materials": {"d": {"density": 1000.0, "heat": {"fourier": {"kappa": kappa, "alpha": 2000.0}}}},
        "surfaces": [{"of": "s", "side": "left", "flux": {"q": 500.0}}],
    }  # fmt: skip
    run = mpm.run_point(mpm.load(data))
    off = abs((run.finals["temperature_max"] - 293.15) / (1000.0 * np.sqrt(60 / (np.pi * max(kappa, 1e-30) * 2e6))) - 1)
    assert run.outcome.ok and ("depth" in kinds(run.facts.get("warnings", ()))) == (kappa <= 1e-3) and (kappa <= 1e-3 or off < 0.03)


@pytest.mark.plain
@pytest.mark.parametrize(("deep", "biot"), [(0.7, 5.0), (0.25, math.inf)])
def test_the_warning_says_how_much_too_much_at_most(deep, biot):
    """A slab that moves, its face at the surroundings or behind beta h/kappa = 5, against the half space (Carslaw & Jaeger 2.5 and 2.7)."""
    h, kappa, capacity = 1e-3, 0.5, 2e6
    D, beta = kappa / capacity, biot * kappa / h
    t = (deep * h) ** 2 / D
    data = {
        "grid": {"dimension": 1, "size": [0.02], "cell": h}, "time": {"end": t}, "output": {"every": t},
        "bodies": {"s": {"shape": {"box": {"lower": [0.005], "upper": [0.015]}}, "temperature": 300.0, "material": "d"}},
        "materials": {"d": {"density": 1000.0, "elastic": {"hencky": {"E": 1000.0 * (2 * h / t) ** 2, "nu": 0.3}},
                            "heat": {"fourier": {"kappa": kappa, "alpha": 2000.0}}}},
        "surfaces": [{"of": "s", "side": "left", "convection": {"beta": beta, "outside": 380.0}}],
    }  # fmt: skip
    run = mpm.run_point(mpm.load(data))
    H = biot * deep
    passed = erfcx(H) / H - 1 / H + 2 / math.sqrt(math.pi) if math.isfinite(H) else 2 / math.sqrt(math.pi)
    off = run.finals["heat_exchanged"] / (80.0 * capacity * deep * h * passed) - 1
    (told,) = (text for text in run.facts["warnings"] if text.startswith("depth"))
    most = float(re.search(r"at most (\d+) % too much", told)[1]) / 100
    assert 0.1 < off < most < 2.2 * off


def test_a_run_that_failed_at_once_is_not_told_that_heat_reached_nowhere():
    """Below absolute zero before its second record."""
    data = {
        "grid": {"dimension": 1, "size": [0.02], "cell": 0.001}, "time": {"end": 600.0}, "output": {"every": 60.0},
        "bodies": {"s": {"shape": {"box": {"lower": [0.005], "upper": [0.015]}}, "temperature": 293.15, "material": "d"}},
        "materials": {"d": {"density": 1000.0, "heat": {"fourier": {"kappa": 0.5, "alpha": 2000.0}}}},
        "surfaces": [{"of": "s", "flux": {"q": -1e5}}],
    }  # fmt: skip
    run = mpm.run_point(mpm.load(data))
    assert run.outcome.kind == "max_principle" and len(run.times) == 1 and "depth" not in kinds(run.facts.get("warnings", ()))


@pytest.mark.parametrize("D", [1, 2])
@pytest.mark.parametrize(("gap", "told"), [(0.0, False), (0.02, False), (0.4, True), (0.95, True), (1.0, False), (3.0, False)])
def test_bodies_that_lie_less_than_a_cell_apart_are_told(gap, told, D):
    """Heat passes where they touch, within a twentieth of a cell, and nowhere else."""
    box = [{"lower": [low] * D, "upper": [high] + [0.008] * (D - 1)} for low, high in ((0.0, 0.006), (0.006 + gap * 1e-3, 0.016))]
    for part in box:
        part["lower"][1:] = [0.0] * (D - 1)
    bodies = {name: {"shape": {"box": part}, "temperature": T, "material": "d"} for name, part, T in zip("ab", box, (370.0, 290.0), strict=True)}
    material = {"density": 1000.0, "heat": {"fourier": {"kappa": 0.5, "alpha": 2000.0}}}
    grid = {"dimension": D, "size": [0.02] * D, "cell": 0.001}
    run = mpm.run_point(mpm.load({"grid": grid, "bodies": bodies, "materials": {"d": material}, "time": {"end": 60.0}, "output": {"every": 60.0}}))
    passes = run.finals["temperature_max"] < 369.0
    assert run.outcome.ok and passes == (gap < 0.05) and ("near" in kinds(run.facts["warnings"])) is told


@pytest.mark.plain
def test_a_probe_whose_particle_is_gone(core):
    """A particle beyond the side that the probe hangs on."""
    experiment = scene(0.0, 4.0)
    assert "probe" in planted(core, experiment, lambda body: body.particles.x.__setitem__(np.argmax(body.particles.x), 7.3))
    assert planted(core, experiment, lambda body: None) == ()


@pytest.mark.parametrize(("changes", "steps", "told"), [({}, 100, True), ({}, 40_000, False), ({"expansion": None}, 100, False), ({"flow": None}, 100, False)])
def test_what_expands_rings_between_long_heat_steps(changes, steps, told):
    """4 m in which sound goes 1.9 m/s: 100 heat steps in 1000 s are 4.7 passages each, and 100 K swell it past its yield; 40 000 are short ones."""
    solid = SOLID | {"expansion": {"linear": {"coefficient": 0.1, "reference": 300.0}}} | changes
    experiment = scene(0.0, 4.0, materials={"solid": {key: law for key, law in solid.items() if law}}, time={"end": 1000.0}, output={"every": 1000.0},
                       surfaces=[{"of": "bar", "side": "right", "convection": {"beta": 1.0, "outside": 400.0}}])  # fmt: skip
    found = list(LOOKS["ring"](experiment, SimpleNamespace(facts={"heat_steps": steps})))
    assert bool(found) is told and (not told or "4.7 times" in found[0])
    assert not list(LOOKS["ring"](named(experiment, "implicit"), SimpleNamespace(facts={"heat_steps": steps})))  # also one that was stopped


@pytest.mark.parametrize(("changes", "cells", "told"), [
    ({}, 2.5, True), ({}, 0.5, False), ({"method.frame": "total"}, 2.5, False), ({"walls": {}}, 2.5, False), ({"walls": {"bottom": "stick"}}, 2.5, False),
    ({"bodies.beam.shape": {"box": {"lower": [0, 0.4], "upper": [0.5, 0.6]}}}, 2.5, False),
    ({"materials.m.flow": {"ellipse": {"M": 9e9, "p0": 1.0, "eta": 1.0}}}, 2.5, False),
])  # fmt: skip
def test_what_bends_far_in_the_updated_frame(changes, cells, told):
    """A beam of five times its height whose lower end falls by 2.5 cells; half a cell, the total frame, no clamp, a block and flow do not warn."""
    experiment = mpm.load({
        "grid": {"dimension": 2, "size": [1.2, 0.8], "cell": 0.05}, "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1e6, "nu": 0.3}}}},
        "bodies": {"beam": {"shape": {"box": {"lower": [0, 0.4], "upper": [1, 0.6]}}, "material": "m"}}, "walls": {"left": "stick"}, "time": {"end": 1},
    }, changes)  # fmt: skip
    ends = {"position_min_x": (0.0, 0.0), "position_max_x": (1.0, 0.99), "position_min_y": (0.4, 0.4 - 0.05 * cells), "position_max_y": (0.6, 0.6)}
    series = {name: np.array(values) for name, values in (ends | {"extent_x": (1.0, 0.99), "extent_y": (0.2, 0.2)}).items()}
    found = list(LOOKS["bend"](experiment, SimpleNamespace(series=series)))
    assert bool(found) is told
    assert not told or "bends by 2.5 cells" in found[0]


def test_every_kind_is_raised_somewhere():
    """Those that only a running scene sees: test_guards.py, test_scaling.py, test_guarded.py, test_narrow.py, test_stretched.py."""
    assert set(LOOKS) == {*PAIRS, "heat", "probe", "depth", "near", "late", "ring", "bend"}
    assert set(LOOKS) | {"temperature", "inertia", "torn", "traction", "narrow", "pieces", "overlap"} == set(KINDS)


def test_expansion_explains_volume(core):
    """Warm gas in a dough may double it, and no warning says so; what it gains beyond is told."""
    from mpm.review import explained

    experiment = core.experiment(1, {"gamma": 0.5, "kappa": 2.0})
    run = mpm.run_point(experiment)
    run.series["temperature_max"] = run.series["temperature_max"] + 10.0
    assert explained(experiment, run, next(iter(experiment.bodies))) == (1.0, pytest.approx(np.exp(0.5 * 10 / (3 + 4 / 3))))
    run.facts["volume_ratios"] = {name: 3.1 for name in run.facts["volume_ratios"]}
    assert kinds(review(experiment, run)) == ()
    run.facts["volume_ratios"] = {name: 3.1 * 1.2 for name in run.facts["volume_ratios"]}
    assert kinds(review(experiment, run)) == ("volume",)


@pytest.mark.plain
def test_a_small_body_that_collapses_beside_a_large_one_is_told():
    """An eleventh of the material flows together under its weight, while the other body falls: of the whole volume that is a few per cent."""
    solids = {"solid": SOLID, "soft": SOLID | {"flow": {"ellipse": {"M": 0.01, "p0": 0.3, "eta": 1.0}}}}
    box = {"a": ((0.0, 0.5), "soft"), "b": ((1.5, 6.5), "solid")}
    bodies = {name: {"shape": {"box": {"lower": [low], "upper": [high]}}, "material": solid} | WARM for name, ((low, high), solid) in box.items()}
    run = mpm.run_point(scene(0.0, 4.0, gravity=-0.1, bodies=bodies, materials=solids, output={"every": 1.0}, time={"end": 4.0}))
    told = [text for text in run.facts["warnings"] if text.startswith("volume")]
    assert run.outcome.ok and [text.split()[7] for text in told] == ["a"] and run.facts["volume_ratios"]["b"] > 0.9


@pytest.mark.plain
@pytest.mark.parametrize(("end", "told"), [(2.0, True), (4.0, False)])
def test_a_measured_curve_that_the_run_does_not_reach_is_told(end, told):
    """Its misfit has no value; where some of it is reached, that is compared."""
    measured = {"tip": {"samples": [[3.0, 301.0], [5.0, 302.0]]}}
    run = mpm.run_point(scene(0.0, 4.0, time={"end": end}, output={"every": 0.5, "probes": {"tip": [3.95]}, "measured": measured}))
    assert np.isnan(run.finals["misfit_tip"]) == told and ("late" in kinds(run.facts["warnings"])) == told
