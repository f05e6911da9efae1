"""No temperature of a moving body beyond those of body and surroundings, to 1e-12 of their difference, with `method.bounds: repair`."""

import numpy as np
import pytest

INF = float("inf")
DIMENSIONS = [1, 2, pytest.param("axisymmetric", marks=pytest.mark.slow), pytest.param(3, marks=pytest.mark.slow)]


def shock(core, dimension, transfer, heat, beta, repair=True, outside=300.0, **sections):
    """A hot box of three cells, flying, whose surface is cooled at once: its corners are a cell wide."""
    body = core.config(dimension)["bodies"]["body"] | {"velocity": [0.0] * (core.DIRECTIONS[dimension] - 1) + [0.4]}
    method = core.methods(transfer) | {"heat": {heat: {}}} | ({"bounds": {"repair": {}}} if repair else {})
    surfaces = [{"of": "body", "convection": {"beta": beta, "outside": outside}}]
    changes = {"kappa": 0.5, "time.end": 0.3, "output.every": 0.03}
    run = core.play(core.experiment(dimension, changes, bodies={"body": body}, surfaces=surfaces, method=method, **sections))[1]
    assert run.outcome.ok and np.abs(run.series["heat_ledger"]).max() < 1e-12 * np.abs(run.series["heat_exchanged"]).max()
    return run


@pytest.mark.parametrize("dimension", DIMENSIONS)
@pytest.mark.parametrize("transfer", ["apic", "flip"])
@pytest.mark.parametrize(("heat", "beta"), [("implicit", INF), ("explicit", 20.0)])
def test_thermal_shock(core, dimension, transfer, heat, beta):
    """Without repair FLIP passes the bounds by up to 62 % and APIC by up to 8 %; with it by nothing, and the ledger closes as before."""
    run = shock(core, dimension, transfer, heat, beta)
    assert run.series["temperature_min"].min() >= core.COLD - 1e-10 and run.series["temperature_max"].max() <= core.HOT + 1e-10
    assert run.facts["heat_unrepaired"] == 0.0
    if transfer == "flip":
        assert run.facts["heat_repaired"] > 0.0
        assert shock(core, dimension, transfer, heat, beta, repair=False).series["temperature_min"].min() < core.COLD - 10


@pytest.mark.slow
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

    scene = build(core.experiment(1, surfaces=surfaces, method={"bounds": {"repair": {}}}))
    return scene, bounds_of(scene.bodies[0])
