"""No temperature of a moving body beyond those of body and surroundings, to 1e-12 of their difference, unless `method.bounds: free` says so."""

from pathlib import Path

import numpy as np
import pytest

import mpm
from mpm.sweep.cases import plan

INF = float("inf")


def shock(core, dimension, transfer, heat, beta, repair=True, outside=300.0, **sections):
    """A hot box of three cells, flying, whose surface is cooled at once: its corners are a cell wide."""
    body = core.config(dimension)["bodies"]["body"] | {"velocity": [0.0] * (core.DIRECTIONS[dimension] - 1) + [0.4]}
    method = core.methods(transfer) | {"heat": {heat: {}}} | ({} if repair else {"bounds": "free"})
    surfaces = [{"of": "body", "convection": {"beta": beta, "outside": outside}}]
    changes = {"kappa": 0.5, "time.end": 0.3, "output.every": 0.03}
    run = core.play(core.experiment(dimension, changes, bodies={"body": body}, surfaces=surfaces, method=method, **sections))[1]
    assert run.outcome.ok and np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
    return run


# Repair neither knows the scheme nor the dimension: both schemes in one, the explicit one in two; more are slow, as each costs a compilation.
SHOCKS = [pytest.param(*case, marks=pytest.mark.plain) for case in (("implicit", INF, 1), ("explicit", 20.0, 1), ("explicit", 20.0, 2))]
MORE = [("implicit", INF, 2), *((*one, D) for one in (("implicit", INF), ("explicit", 20.0)) for D in ("axisymmetric", 3))]
SHOCKS += [pytest.param(*case, marks=pytest.mark.slow) for case in MORE]


@pytest.mark.parametrize("transfer", ["apic", "flip"])
@pytest.mark.parametrize(("heat", "beta", "dimension"), SHOCKS)
def test_thermal_shock(core, dimension, transfer, heat, beta):
    """Without repair FLIP passes the bounds by up to 62 % and APIC by up to 8 %; with it by nothing, and the ledger closes as before."""
    run = shock(core, dimension, transfer, heat, beta)
    assert run.series["temperature_min"].min() >= core.COLD - 1e-10 and run.series["temperature_max"].max() <= core.HOT + 1e-10
    assert run.facts["heat_unrepaired"] == 0.0
    if transfer == "flip":
        assert run.facts["heat_repaired"] > 0.0
        assert shock(core, dimension, transfer, heat, beta, repair=False).series["temperature_min"].min() < core.COLD - 10


CONFIGS = Path(__file__).parents[2] / "configs"
SLUMP, SLAB = CONFIGS / "scenes" / "slump.yaml", CONFIGS / "verification" / "robin_slab_particles.yaml"


@pytest.mark.slow
@pytest.mark.parametrize("changes", [{"beta": 2000.0}, {"beta": 5000.0, "kappa": 0.1, "alpha": 4000.0}, {"beta": 5000.0, "kappa": 0.1, "alpha": 1000.0}])
def test_slump_over_its_ranges(changes):
    """Dough of 30 degC on a floor of 90 degC: without repair its inside falls by up to 10 % of the range below its start, and says so."""
    run, free = (mpm.run_point(mpm.load(SLUMP, changes | {"method.bounds": bounds})) for bounds in ("auto", "free"))
    assert run.outcome.ok and run.series["temperature_min"].min() >= 303.15 - 1e-9 and run.series["temperature_max"].max() <= 363.15 + 1e-9
    assert not any(text.startswith("temperature") for text in run.facts.get("warnings", ()))
    assert free.series["temperature_min"].min() < 303.15 - 0.005 * 60 and any(text.startswith("temperature") for text in free.facts["warnings"])


def test_flip_behind_a_held_side(core):
    """A slab cooled through both faces, against the series: repaired FLIP keeps slopes there. Without them repair is an exchange of its own: 3.3e-2, 2.3e-2."""
    changes = {"beta": INF, "method.temperature": "flip", "time.end": 0.2}
    coupled = {name: core.config()["materials"]["solid"][name] for name in ("expansion", "heating")}  # of zero: no compilation of its own
    errors = []
    for cell in (0.0625, 0.03125):
        config = mpm.load(SLAB, changes | {"grid.cell": cell}).resolved()
        (material,) = config["materials"].values()
        run = mpm.run_point(mpm.load(config | {"materials": {name: material | coupled for name in config["materials"]}}))
        assert run.outcome.ok and run.series["temperature_min"].min() >= 300 - 1e-10
        assert np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
        errors.append(run.finals["error_l2"])
    assert errors[0] < 2.5e-3 and errors[1] < 0.6 * errors[0]


def data(experiment):
    """Lowest and highest temperature of bodies at the start and of what surrounds them."""
    found = [body.temperature for body in experiment.bodies.values()]
    for surface in experiment.surfaces:
        found += [surface.convection.outside] if surface.convection is not None else []
    return min(found), max(found)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["smoke", "scenes/slump", "scenes/loaf", "scenes/loaf_oven_spring", "scenes/slab"])
def test_shipped_scenes_stay_within_their_data(name):
    """Every point of every scene that has heat and is not a material point: 0.5 % of the range is asked for; nor is anything else warned of."""
    for case in plan(mpm.load(CONFIGS / f"{name}.yaml")).cases:
        run, (low, high) = mpm.run_point(case.experiment), data(case.experiment)
        assert run.outcome.ok and not run.facts.get("warnings"), (case.values, run.outcome, run.facts.get("warnings"))
        over = max(low - run.series["temperature_min"].min(), run.series["temperature_max"].max() - high) / (high - low)
        assert over < 5e-3, (case.values, over)


@pytest.mark.slow
@pytest.mark.parametrize("transfer", ["apic", "affine_flip", "flip", "xpic", "pic"])
@pytest.mark.parametrize("dimension", ["axisymmetric", 3])
def test_a_drop_that_melts_over_a_wall(core, dimension, transfer):
    """Latent heat, every transfer of temperature: the fall of 20 K overshoots nowhere (APIC in 3-D by 0.6 % without repair, and more later on)."""
    centre, size, end = ([0.006, 0.006, 0.003], [0.012, 0.012, 0.008], 0.3) if dimension == 3 else ([0, 0.003], [0.006, 0.008], 2.0)
    ball = {"shape": {"ball": {"centre": centre, "radius": 0.003}}, "temperature": 313.15, "material": "fat"}
    heat = {"kappa": 0.2, "alpha": {"bump": {"base": 2000.0, "heat": 1.5e5, "at": 305.15, "width": 1.0}}}
    run = mpm.run_point(mpm.load({
        "grid": {"dimension": dimension, "size": size, "cell": 0.001}, "bodies": {"drop": ball}, "gravity": [0] * (len(size) - 1) + [-9.81],
        "materials": {"fat": {"density": 900.0, "elastic": {"hencky": {"E": 2e4, "nu": 0.4}}, "heat": {"fourier": heat}}},
        "walls": {"bottom": {"contact": {"heat": {"beta": 2000.0, "temperature": 293.15}}}}, "time": {"end": end}, "output": {"every": end / 10},
        "method": {"temperature": transfer},
    }))  # fmt: skip
    assert run.outcome.ok and run.facts["heat_unrepaired"] == 0.0 and run.series["temperature_min"].min() < 313.15 - 0.5
    assert run.series["temperature_min"].min() >= 293.15 - 1e-9 and run.series["temperature_max"].max() <= 313.15 + 1e-9


@pytest.mark.plain
def test_heating_shock_with_latent_heat(core):
    """From below, through a bump of alpha: enthalpy is what is moved."""
    alpha = {"bump": {"base": 1.5, "heat": 60.0, "at": 450.0, "width": 2.0}}
    material = core.config(1)["materials"]["solid"] | {"heat": {"fourier": {"kappa": 0.5, "alpha": alpha}}}
    run = shock(core, 1, "flip", "implicit", INF, outside=500.0, materials={"solid": material})
    assert run.facts["heat_repaired"] > 0.0 and run.series["temperature_max"].max() <= 500.0 + 1e-10


def test_apic_stays_as_accurate(core):
    """The corner of a box passes the air by 8 % of the fall; repair brings it back, and the mean moves by 0.02 %."""
    with_it, without = (shock(core, 2, "apic", "explicit", 20.0, repair) for repair in (True, False))
    assert without.series["temperature_min"].min() < core.COLD - 5
    assert with_it.finals["temperature_mean"] == pytest.approx(without.finals["temperature_mean"], abs=0.02)


def test_radiation_and_flux(core):
    """Radiating to the sky bounds below; a flux into the body lifts the upper bound and leaves the lower."""
    sky = {"of": "body", "radiation": {"emissivity": 1.0, "surroundings": 300.0}}
    for surfaces, low, high in (([sky], 300.0, 400.0), ([sky, {"of": "body", "flux": {"q": 50.0}}], 300.0, np.inf)):
        scene, between = peek(core, surfaces)
        assert between == (low - scene.bodies[0].thermal.zero, high - scene.bodies[0].thermal.zero)


def peek(core, surfaces):
    """(scene, its bounds at the start)."""
    from mpm.integrate.bounds import bounds_of
    from mpm.scene.build import build

    scene = build(core.experiment(1, surfaces=surfaces))
    return scene, bounds_of(scene.bodies[0], np.array([np.inf, -np.inf]))


@pytest.mark.plain
@pytest.mark.parametrize("D", [1, 2, 3])
def test_repair_against_sums_over_all_particles(D):
    """Some particles of a body at a mirror are too hot: what each receives, by the sums of the module's head over every particle and node."""
    from mpm.boundary import CONTACT, SLIP
    from mpm.integrate.bounds import FIELDS, repair
    from mpm.materials.laws import Constant
    from mpm.state import PAD, Line, Particles, Plane, Thermal, Volume
    from mpm.transfer import CHUNK, gather_scalar, scatter_scalar

    h, cells, N, rng = 0.1, 10 if D < 3 else 6, 300, np.random.default_rng(5)
    space, size = (Line, Plane, Volume)[D - 1](h, *[cells + 1 + 2 * PAD] * D), cells + 1 + 2 * PAD
    x, m, theta = h * (0.1 + (cells - 1) * rng.random((N, D))), 1 + rng.random(N), -1 - rng.random(N)
    hot = np.flatnonzero(np.all(x < 0.3 * h * cells, axis=1))
    theta[hot[::2]] = 0.5
    walls, nodes, zero = np.full((3, 2), CONTACT), np.zeros((FIELDS, size**D)), np.zeros((D, CHUNK))
    walls[0, 0] = SLIP
    thermal = Thermal(theta.copy(), np.zeros((N, D)), 300.0, Constant(1.0), Constant(2.0))
    moved, left = repair(space, Particles(x, *np.zeros((4, N)), m, m), thermal, nodes, walls, 0.0, 1.0)

    e, r, E, R = np.maximum(2 * m * theta, 0), np.maximum(-2 * m * theta, 0), np.zeros(size**D), np.zeros(size**D)
    for p in range(N):
        scatter_scalar(space, x, p, 1, e[p : p + 1], zero, zero, E)
        scatter_scalar(space, x, p, 1, r[p : p + 1], zero, zero, R)
    E, R = E.reshape([size] * D), R.reshape([size] * D)
    for k in range(1, PAD + 1):  # what lies behind the mirror counts before it, and is seen there
        E[PAD + k] += E[PAD - k]
        R[PAD + k] += R[PAD - k]
    share = np.where(R > 0, np.minimum(1, E / np.where(R > 0, R, 1)), 0)
    for k in range(1, PAD + 1):
        share[PAD - k] = share[PAD + k]
    value, slope = np.zeros(1), np.zeros((D, 1))
    taken = np.zeros(N)
    for p in range(N):
        gather_scalar(space, x, p, 1, share.ravel(), value, slope, np.zeros((D, 1)))
        taken[p] = r[p] * value[0]
    rest = (e.sum() - taken.sum()) / (r.sum() - taken.sum())
    expected = np.where(e > 0, 0.0, theta + (taken + rest * (r - taken)) / (2 * m))
    assert left == 0.0 and moved == pytest.approx(e.sum(), rel=1e-13) and not nodes.any() and 0 < np.count_nonzero(taken) < N
    assert thermal.theta == pytest.approx(expected, abs=1e-13)
