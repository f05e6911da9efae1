"""Inflow: what comes in, how it moves in its nozzle and past the mouth, its books, and what becomes of a run that is cut."""

import numpy as np
import pytest

import mpm
from mpm.inflow import first
from mpm.integrate import sorting
from mpm.scene.build import build
from mpm.scene.inflow import column

pytestmark = pytest.mark.plain

HEAT = {"fourier": {"kappa": 0.001, "alpha": 1.5}}
NOZZLES = {1: ([0.0], [0.2], [0.5]), 2: ([0.3, 0.7], [0.5, 0.9], [0, -0.5]), "axisymmetric": ([0.0, 0.7], [0.2, 0.9], [0, -0.5]),
           3: ([0.3, 0.3, 0.7], [0.5, 0.5, 0.9], [0, 0, -0.5])}  # fmt: skip
AREA = {1: 1.0, 2: 0.2, "axisymmetric": np.pi * 0.2**2, 3: 0.04}


def config(dimension=2, flow=None, **more):
    """A stream of density 2 that comes in from 0.1 s to 0.7 s at 0.5 m/s, without weight."""
    lower, upper, velocity = NOZZLES[dimension]
    body = {"shape": {"box": {"lower": lower, "upper": upper}}, "material": "m", "temperature": 300.0,
            "inflow": {"velocity": velocity, "from": 0.1, "until": 0.7} | (flow or {})}  # fmt: skip
    return {"grid": {"dimension": dimension, "size": [1.0] * len(lower), "cell": 0.1}, "bodies": {"s": body},
            "materials": {"m": {"density": 2.0, "elastic": {"hencky": {"E": 5.0, "nu": 0.3}}, "heat": HEAT}},
            "time": {"end": 0.8}, "output": {"every": 0.2}} | more  # fmt: skip


def run_of(data, **over):
    run = mpm.run_point(mpm.load(data, over))
    assert run.outcome.ok, run.outcome
    return run


@pytest.mark.parametrize("dimension", [1, 2, "axisymmetric", pytest.param(3, marks=pytest.mark.wide)])
def test_a_stream_without_weight_keeps_its_speed_and_bears_no_stress(dimension):
    run = run_of(config(dimension))
    come, axis = 2.0 * AREA[dimension] * 0.5 * 0.6, {1: "x", 2: "y"}.get(dimension, "z")
    assert run.series["mass_total"][-1] == pytest.approx(come, rel=1e-12)
    assert abs(run.series[f"momentum_{axis}"][-1]) == pytest.approx(0.5 * come, rel=1e-12)
    assert run.series["strain_max"].max() < 1e-14 and np.ptp([run.series["J_min"], run.series["J_max"]]) < 1e-14
    assert np.abs(run.series["dissipation_transfer"]).max() < 1e-14
    assert not run.facts["warnings"]


@pytest.mark.parametrize("transfer", ["apic", "pic", {"flip": {"blend": 0.02}}, "affine_flip"])
@pytest.mark.parametrize("gradient", ["mls", "bspline"])
def test_every_transfer_of_a_stream(transfer, gradient):
    run = run_of(config(), **{"method.transfer": transfer, "method.gradient": gradient})
    assert run.series["strain_max"].max() < 1e-14 and run.series["velocity_max"][-1] == pytest.approx(0.5, rel=1e-12)


def test_mass_is_that_of_the_rate_to_one_layer():
    run = run_of(config(2, output={"every": 0.05}))
    passed = 2.0 * AREA[2] * 0.5 * np.clip(run.times - 0.1, 0.0, 0.6)
    there = np.minimum(passed + 2.0 * AREA[2] * 0.2, 2.0 * AREA[2] * 0.3)  # with what stands in the nozzle
    assert np.all(np.abs(run.series["mass_total"] - there) <= 2.0 * AREA[2] * 0.05 * (1 + 1e-9))
    assert np.ptp(run.series["mass_total"] - run.series["mass_inflow"]) < 1e-15


def test_a_rate_over_time_comes_in_as_its_integral():
    table = {"table": {"time": [0.1, 0.3, 0.3, 0.7], "value": [0.0, -1.0, -0.25, -0.25]}}
    data = config(2, {"velocity": [0, table]}, output={"every": 0.1})
    run, scene = run_of(data), build(mpm.load(data))
    assert run.series["mass_total"][-1] == pytest.approx(2.0 * AREA[2] * 0.2, rel=1e-12)
    assert column(mpm.load(data), "s").length == pytest.approx(0.2, rel=1e-12)
    stream = scene.inflow.streams[0]
    for k in range(1, stream.layers + 1):
        assert stream.travel(stream.times[k]) == pytest.approx(k * stream.layer, rel=1e-9)


def test_a_volume_rate_is_that_of_the_whole_mouth():
    flow = {"rate": {"table": {"time": [0, 1], "value": [0.1, 0.1]}}, "velocity": None}
    for dimension, gravity in (("axisymmetric", [0, -1e-9]), (3, [0, 0, -1e-9])):
        data = config(dimension, flow, gravity=gravity)
        data["bodies"]["s"]["inflow"].pop("velocity")
        assert column(mpm.load(data), "s").length == pytest.approx(0.1 / AREA[dimension] * 0.6, rel=1e-12)


def test_what_is_in_the_nozzle_moves_as_told_under_weight():
    run = run_of(config(2, gravity=[0, -1.0], output={"every": 0.2, "snapshots": {"every": 0.1, "particles": ["position", "velocity", "J"]}}))
    for k, fields in enumerate(run.particles[2:5], 2):
        inside = fields["position"][:, 1] > 0.7 + 1e-9
        assert inside.any() and np.abs(fields["velocity"][inside] - [0.0, -0.5]).max() < 1e-12, k
        assert np.abs(fields["J"][inside] - 1.0).max() == 0.0
    below = run.particles[4]["position"][:, 1] < 0.6
    assert run.particles[4]["velocity"][below, 1].max() < -0.5  # it falls


def test_energy_closes_under_weight():
    run = run_of(config(2, gravity=[0, -1.0]))
    s = run.series
    begun = s["energy_total"] - s["energy_total"][0]
    assert np.abs(s["energy_inflow"] + s["work_loads"] - s["dissipation_transfer"] - begun).max() < 1e-15
    lost = s["dissipation_transfer"][-1]
    assert 0 < lost < 0.05 * s["energy_kinetic"][-1]


def test_heat_that_comes_in_is_in_the_ledger():
    warmer = {"table": {"time": [0.1, 0.7], "value": [310.0, 370.0]}}
    surfaces = [{"of": "s", "convection": {"beta": 0.5, "outside": 280.0}}]
    run = run_of(config(2, {"temperature": warmer}, surfaces=surfaces, output={"every": 0.05}))
    s = run.series
    assert np.abs(s["heat_ledger"]).max() < 1e-12 * np.abs(s["heat_total"]).max()
    fed = 2.0 * AREA[2] * 1.5 * 0.5 * 0.6 * (340.0 - 300.0)  # of all of it; the first two cells stand in the nozzle at the start
    first_cells = 2.0 * AREA[2] * 1.5 * 0.2 * (330.0 - 300.0)
    assert s["heat_inflow"][-1] == pytest.approx(fed - first_cells, rel=1e-9)
    assert s["heat_exchanged"][-1] < 0


def test_nothing_is_exchanged_in_the_nozzle():
    surfaces = [{"of": "s", "convection": {"beta": 0.5, "outside": 280.0}}]
    run = run_of(config(2, {"from": 0.6, "until": 1.2}, surfaces=surfaces, output={"every": 0.1}))
    assert np.abs(run.series["heat_exchanged"][:7]).max() == 0.0 and run.series["heat_exchanged"][-1] < 0
    assert run.series["area_exchanging"][0] == 0.0


def test_particles_that_are_still_to_come_cost_no_step_anything():
    scene = build(mpm.load(config(2)))
    whole, now = scene.wholes[0], scene.bodies[0]
    assert len(now.particles.m) == 16 and len(whole.particles.m) == 24
    assert np.shares_memory(now.particles.x, whole.particles.x) and now.particles.x.flags.c_contiguous
    assert len(first(whole, 4, 2).source.behind) == 4


class Cut:
    """A keeper that stops a run once and keeps its memory."""

    def __init__(self, found=None):
        self.found, self.kept, self.looks = found, None, 0

    def due(self, stop):
        return stop

    def save(self, memory):
        self.kept = memory


@pytest.mark.parametrize("cut", [2, 5, 8])
def test_a_run_that_was_cut_goes_on_with_the_same_bits(cut):
    from mpm.simulation import simulate

    data = config(2, gravity=[0, -1.0], surfaces=[{"of": "s", "convection": {"beta": 0.5, "outside": 280.0}}])
    whole, keeper, count = simulate(build(mpm.load(data))), Cut(), [0]

    def beat(*_):
        count[0] += 1
        return count[0] == cut

    simulate(build(mpm.load(data)), beat, keeper)
    assert keeper.kept is not None
    again = simulate(build(mpm.load(data)), None, Cut(keeper.kept))
    assert all(np.array_equal(whole.series[name], again.series[name]) for name in whole.series)


def test_any_number_of_threads_and_slabs_gives_the_same_bits(monkeypatch):
    """A long stream, in slabs from the first block on: new layers are behind all slabs, so each that comes in is a reason to sort anew."""
    from mpm.simulation import simulate

    monkeypatch.setattr(sorting, "SHARED", 1)
    monkeypatch.setattr(sorting, "FULL", 1)
    data = config(2, {"from": 0.0, "until": 0.4}, time={"end": 0.5})
    data["bodies"]["s"]["shape"]["box"] = {"lower": [0.1, 0.7], "upper": [0.9, 0.9]}
    found = []
    for threads in (1, 2):
        scene = build(mpm.load(data))
        scene.threads = threads
        run = simulate(scene)
        assert run.outcome.ok and scene.order.shared
        found.append(b"".join(values.tobytes() for values in run.series.values()))
    assert found[0] == found[1] and run.series["strain_max"].max() < 1e-14


def test_single_precision_keeps_a_stream_as_it_is():
    run = run_of(config(2), **{"method.precision": "float32"})
    assert run.series["strain_max"].max() < 1e-5 and run.series["mass_total"][-1] == pytest.approx(0.12, rel=1e-6)


def test_a_stream_that_falls_on_a_hot_wall_takes_heat_from_it():
    heat = {"beta": 5.0, "temperature": 400.0}
    data = config(2, {"from": 0.0, "until": 0.4}, walls={"bottom": {"contact": {"friction": 0.3, "heat": heat}}}, gravity=[0, -1.0], time={"end": 0.6})
    data["bodies"]["s"]["shape"]["box"] = {"lower": [0.3, 0.1], "upper": [0.5, 0.3]}
    run = run_of(data, **{"materials.m.elastic.hencky.E": 20.0})
    s = run.series
    assert s["heat_exchanged"][-1] > 0 and np.abs(s["heat_ledger"]).max() < 1e-12 * s["heat_total"][-1]
    assert s["force_bottom_y"].max() > 0 and s["position_min_y"].min() == pytest.approx(0.0, abs=5e-3)
    assert s["mass_total"][-1] == pytest.approx(2.0 * 0.2 * 0.2, rel=1e-12)


@pytest.mark.parametrize("weight", [0.0, 1.0])
def test_implicit_steps(weight):
    """Without weight as exact as explicit ones; with it the books close, and what has left the nozzle falls faster than it."""
    run = run_of(config(1, gravity=[weight], method={"mechanics": "implicit"}))
    s = run.series
    assert s["mass_total"][-1] == pytest.approx(0.6, rel=1e-12) and np.abs(s["heat_ledger"]).max() < 1e-12
    begun = s["energy_total"] - s["energy_total"][0]
    assert np.abs(s["energy_inflow"] + s["work_loads"] - s["dissipation_transfer"] - begun).max() < 1e-14
    if weight == 0.0:
        assert s["momentum_x"][-1] == pytest.approx(0.3, rel=1e-12) and s["strain_max"].max() < 1e-14
        assert np.abs(s["dissipation_transfer"]).max() < 1e-14
    else:
        assert s["velocity_max"][-1] > 0.6


@pytest.mark.slow
def test_a_jet_pushes_on_a_wall_with_its_momentum():
    """A plane jet that a wall turns by 90 degrees: rho A v^2, half of it in symmetry, in the mean over its ringing once the blow with which it comes on,
    2.7 times that, is 0.2 s past: 0.96 of it to 1.2 s, 1.05 to 3 s."""
    data = {
        "grid": {"dimension": 2, "size": [1.0, 0.8], "cell": 0.05},
        "bodies": {"jet": {"shape": {"box": {"lower": [0.0, 0.6], "upper": [0.1, 0.8]}}, "material": "m", "inflow": {"velocity": [0, -1.0], "until": 2}}},
        "materials": {"m": {"density": 1.0, "elastic": {"hencky": {"E": 20.0, "nu": 0.3}}, "flow": {"ellipse": {"M": 0.05, "p0": 100.0, "eta": 0.0}}}},
        "walls": {"bottom": {"contact": {}}}, "time": {"end": 1.2}, "output": {"every": 0.05},
    }  # fmt: skip
    run = run_of(data)
    assert run.series["force_bottom_y"][17:].mean() == pytest.approx(0.1, rel=0.05)


def test_a_sweep_over_what_flows_in(tmp_path):
    """Over rate and temperature of a round stream: a dataset with both axes, the mass of each point what its rate brings, its heat that of its temperature."""
    from mpm.sweep.api import execute, tree_of
    from mpm.sweep.engine import Options

    body = config("axisymmetric", {"rate": 0.1})
    del body["bodies"]["s"]["inflow"]["velocity"]
    rates, warm = [0.03, 0.06, 0.08], [300.0, 320.0]
    data = body | {"gravity": [0, -0.01], "sweep": {"axes": {"rate": rates, "inflow.temperature": warm}}}
    assert execute(mpm.load(data), tmp_path, Options(jobs=0)).exit_code == 0
    found = tree_of(tmp_path / "sweep.nc")
    assert found.sizes == {"rate": 3, "inflow_temperature": 2} and not found.warnings.values.any()
    assert found.rate.attrs["units"] == "m3/s" and found.mass_total[:, 0].values == pytest.approx([2 * 0.6 * rate for rate in rates], rel=1e-12)
    assert found.heat_inflow[:, 0].values == pytest.approx(0.0, abs=1e-12)
    assert (found.heat_inflow / found.mass_inflow)[1:, 1].values == pytest.approx(1.5 * 20.0, rel=1e-12)
