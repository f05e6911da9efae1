"""The ledger of energy: what nothing in a config accounts for goes to nothing with FLIP, so every term is there; what a transfer takes is told."""

import numpy as np
import pytest

import mpm

BAR = {"box": {"lower": [1.0], "upper": [6.0]}}
GRID = {"dimension": 1, "size": [7.0], "cell": 0.125}
FLIP = {"transfer": {"flip": {}}, "temperature": {"flip": {}}}


def bar(core, drop=(), changes=None, **sections):
    bodies = {"body": {"shape": BAR, "temperature": core.HOT, "material": "solid"}}
    return core.experiment(1, changes, drop, grid=GRID, bodies=bodies, **({"time": {"end": 4.0}, "output": {"every": 0.5}} | sections))


def swing(scene):
    p = scene.bodies[0].particles
    p.v[:, 0] = 0.1 * np.sin(np.pi * (p.x[:, 0] - 3.5) / 5.0)


def test_expansion_and_what_it_heats(core):
    """A bar that its air warms expands, and cools where it stretches: thermal stress works as much as is stored, moves and becomes heat."""
    air = [{"of": "body", "convection": {"beta": 5.0, "outside": core.HOT + 60}}]
    hot = {"gamma": 0.02, "output.every": 0.25, "kappa": 2.0}
    run = core.play(bar(core, changes=hot, surfaces=air, method=FLIP, time={"end": 8.0}))[1]
    stored = run.series["energy_elastic"] + run.series["energy_kinetic"]
    assert run.outcome.ok and stored.max() > 1e-3
    assert np.abs(run.series["dissipation_transfer"]).max() < 0.02 * stored.max()
    assert np.abs(run.series["energy_ledger"] + run.series["dissipation_transfer"] - run.series["heat_ledger"]).max() < 1e-12 * run.series["heat_total"].max()


@pytest.mark.plain
def test_flow(core):
    """A bar that swings past its yield stress: what flow dissipates is what is missing."""
    flow = {"ellipse": {"M": 0.05, "p0": 1.0, "eta": 1.0}}
    data = bar(core, ("surfaces", "expansion", "heating", "heat"), method={"transfer": {"flip": {}}}).resolved()
    data["materials"]["solid"]["flow"] = flow
    run = core.play(mpm.load(data), swing)[1]
    assert run.outcome.ok and run.finals["dissipation_total"] > 0.3 * run.series["energy_kinetic"][0]
    assert abs(run.finals["dissipation_transfer"]) < 0.02 * run.finals["dissipation_total"]


@pytest.mark.wide
def test_moduli_that_follow_temperature(core):
    """A bar that expands while its modulus falls: the energy that softening takes is no loss."""
    air = [{"of": "body", "convection": {"beta": 5.0, "outside": core.HOT + 60}}]
    data = bar(core, ("heating",), surfaces=air, method=FLIP, time={"end": 8.0}).resolved()
    solid = data["materials"]["solid"]
    solid["elastic"] = {"hencky": {"E": {"table": {"temperature": [core.HOT, core.HOT + 60], "value": [5.0, 1.0]}}, "nu": 0.3}}
    solid["expansion"] = {"linear": {"coefficient": 1e-3, "reference": core.HOT}}
    solid["heat"]["fourier"]["kappa"] = 2.0
    run = core.play(mpm.load(data))[1]
    stored = run.series["energy_elastic"] + run.series["energy_kinetic"]
    assert run.outcome.ok and run.series["energy_elastic"].max() > 1.5 * run.finals["energy_elastic"] > 0
    assert np.abs(run.series["dissipation_transfer"]).max() < 0.03 * stored.max()


@pytest.mark.plain
def test_what_apic_takes(core):
    """A bar that swings in waves of eight cells: nothing but the transfer takes its energy, affine FLIP least."""

    def wave(scene):
        p = scene.bodies[0].particles
        p.v[:, 0] = 0.1 * np.sin(2 * np.pi * (p.x[:, 0] - 3.5))

    took = {}
    for transfer in ("apic", "affine_flip"):
        data = bar(core, ("surfaces", "expansion", "heating", "heat"), method={"transfer": {transfer: {}}}, time={"end": 2.0})
        run = core.play(data, wave)[1]
        energy = run.series["energy_total"]
        assert run.series["dissipation_transfer"] == pytest.approx(energy[0] - energy, rel=1e-12, abs=1e-15 * energy[0])
        took[transfer] = run.finals["dissipation_transfer"] / energy[0]
    assert abs(took["affine_flip"]) < 0.1 and took["apic"] > 0.3


@pytest.mark.plain
def test_loads_in_the_total_frame(core):
    """Pulled slowly to rest, the bar stores what traction and drag worked on it: M e^2/2 of its volume, with e/exp(e) = T/M."""
    bodies = {"body": {"shape": {"box": {"lower": [0], "upper": [1.07]}}, "material": "solid"}}
    run = core.play(mpm.load(core.config(
        1, grid={"dimension": 1, "size": [2.0], "cell": 0.0625}, bodies=bodies, surfaces=[], method={"frame": "total"},
        materials={"solid": {"density": 1.0, "elastic": {"hencky": {"lam": 0.2, "mu": 0.4}}}}, walls={"left": "stick"},
        loads=[{"of": "body", "side": "right", "traction": {"nominal": [0.08], "ramp": 8.0}}, {"of": "body", "drag": {"rate": 3.0}}],
        time={"end": 24.0}, output={"every": 12.0},
    )))[1]  # fmt: skip
    e = 0.08
    for _ in range(50):
        e = 0.08 * np.exp(e)
    assert run.outcome.ok and run.finals["work_loads"] == pytest.approx(1.07 * e * e / 2, rel=2e-3)
    assert abs(run.finals["dissipation_transfer"]) < 2e-3 * run.finals["work_loads"]


@pytest.mark.plain
@pytest.mark.parametrize(("transfer", "slopes"), [("apic", 1.0), ("flip", 0.0)])
def test_kinetic_energy_of_a_disc_that_turns(transfer, slopes):
    """1/4 m R^2 omega^2 (1 - s^2/(3 R^2)) of points s apart, and h^2/R^2 of the slopes that the transfer keeps; nothing is lost at the first step."""
    ball = {"shape": {"ball": {"centre": [8.2, 7.9], "radius": 5.0}}, "angular_velocity": 3.0, "material": "m"}
    run = mpm.run_point(mpm.load({
        "grid": {"dimension": 2, "size": [16.0, 16.0], "cell": 1.0}, "bodies": {"disc": ball},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"lam": 300.0, "mu": 200.0}}}},
        "time": {"end": 0.01}, "output": {"every": 0.01}, "method": {"transfer": transfer},
    }))  # fmt: skip
    whole = 0.25 * np.pi * 5.0**4 * 9.0
    assert run.series["energy_kinetic"] == pytest.approx(whole * (1 - 0.25 / 75 + slopes / 25), rel=5e-4)
    assert np.abs(run.series["dissipation_transfer"]).max() < 1e-4 * whole
