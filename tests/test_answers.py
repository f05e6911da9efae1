"""What a config asks for is in the dataset, or it is refused with a place, or the run fails by name: over observables, fields and solvers."""

import copy
import re

import pytest

import mpm
from mpm.outcome import Outcome, Run
from mpm.records.variables import FAILED, FIELDS_GRID, FIELDS_PARTICLES, OBSERVABLES, dataset_name
from mpm.runner import complete, run_point
from mpm.scene.refusal import SceneError
from mpm.sweep.worker import compute

EVERYWHERE = {"temperature.mean", "temperature.max", "heat.total", "heat.exchanged", "heat.ledger"}
MOVING = {"mass.total", "volume.total", "energy.total", "momentum.x", "extent.x", "pressure.mean", "J.min"}
POINT = {"temperature.mean", "stress.xx", "strain.elastic_zz", "kirchhoff.q", "J.min"}


def base(core, solver, dimension):
    """(config, probe) of a small scene that a solver runs."""
    data = core.config(dimension)
    solid = data["materials"]["solid"]
    if solver == "rigid":
        for part in ("elastic", "expansion", "heating"):
            del solid[part]
    if solver == "cold":
        data["materials"]["solid"] = {"density": solid["density"], "elastic": solid["elastic"]}
        data["surfaces"] = []
    return data, [1.0] * core.DIRECTIONS[dimension] if dimension != "axisymmetric" else [0.5, 1.0]


def point():
    material = {"density": 2.0, "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}}, "heat": {"fourier": {"kappa": 0.0, "alpha": 1.5}}}
    bodies = {"body": {"shape": "point", "temperature": 300.0, "material": "solid"}}
    loading = [{"strain_rate": {"zz": -0.01}}]
    return {"grid": {"dimension": 0}, "bodies": bodies, "materials": {"solid": material}, "loading": loading, "time": {"end": 0.5}, "output": {"every": 0.1}}


def accepted(data, output):
    """The config with an output section; None where it is refused, which must be with a place."""
    try:
        return mpm.load(copy.deepcopy(data) | {"output": {"every": 0.1} | output})
    except mpm.ConfigError as error:
        assert "output." in str(error)
        return None


SOLVERS = [("moving", 1, EVERYWHERE | MOVING), ("cold", 1, MOVING), ("rigid", "axisymmetric", EVERYWHERE | {"mass.total", "volume.total"}), ("point", 0, POINT)]


@pytest.mark.parametrize("solver, dimension, least", SOLVERS)
@pytest.mark.plain
def test_what_is_accepted_is_answered(core, solver, dimension, least):
    data, probe = base(core, solver, dimension) if solver != "point" else (point(), [])
    observables = [name for name in OBSERVABLES if accepted(data, {"observables": [name]})]
    grid = [name for name in FIELDS_GRID if accepted(data, {"snapshots": {"every": 0.1, "grid": [name]}})]
    particles = [name for name in FIELDS_PARTICLES if accepted(data, {"snapshots": {"every": 0.1, "particles": [name]}})]
    output = {"observables": observables} | ({"snapshots": {"every": 0.1, "grid": grid, "particles": particles}} if grid else {})
    if accepted(data, {"probes": {"probe": probe}}):
        output |= {"probes": {"probe": probe}, "observables": [*observables, "time_to.probe.350_K"]}
    assert least <= {*observables} and (solver in ("cold", "point")) == ("probes" not in output or solver == "point")
    assert (len(grid), len(particles)) == {"moving": (4, 16), "cold": (4, 16), "rigid": (1, 0), "point": (0, 0)}[solver]
    run = run_point(accepted(data, output))  # which says so itself where something is left out
    assert run.outcome.ok and {dataset_name(name) for name in output["observables"]} <= {*run.series, *run.finals}
    assert not grid or (len(run.snapshot_times) == 6 and all(any(name.startswith(field) for name in run.grid) for field in grid))
    assert not particles or set(run.particles[-1]) == {*particles}
    assert "probes" not in output or "temperature_probe" in run.series


def test_what_is_left_out_fails_by_name(core, monkeypatch):
    data, probe = base(core, "moving", 1)
    output = {"observables": ["mass.total", "temperature.mean"], "probes": {"p": probe}, "snapshots": {"every": 0.1, "grid": ["velocity"], "particles": ["J"]}}
    experiment = accepted(data, output)
    run = Run(Outcome("completed"), [0.0], {"temperature_mean": [1.0]}, {})
    lacking = ["mass.total", "probes.p", "snapshots.grid.velocity", "snapshots.particles.J"]
    with pytest.raises(SceneError, match=re.escape("output.observables.0: " + ", ".join(lacking) + ": ")):
        complete(experiment, run)
    assert complete(experiment, Run(Outcome("budget"), [0.0], {}, {})).outcome.kind == "budget"
    monkeypatch.setattr("mpm.runner.run_point", lambda *_, **__: complete(experiment, run))
    record = compute("id", lambda: experiment, "mpm.runner", None)
    assert record.status == FAILED and record.error.startswith("failed: output.observables.0: mass.total, ")
