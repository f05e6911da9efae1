"""load: sources, extends, overrides, smoke; resolved and key."""

import json
import math
import os
import pickle

import pytest

from mpm.config import ConfigError, Experiment, Problem, load
from mpm.config.laws import Bump, Constant


def problems(source, overrides=None, smoke=False) -> list[Problem]:
    with pytest.raises(ConfigError) as caught:
        load(source, overrides, smoke)
    return caught.value.problems


def test_values_are_si_floats(loaf):
    experiment = load(loaf)
    fourier = experiment.materials["dough"].heat
    assert isinstance(fourier.kappa, Constant) and fourier.kappa.value == 0.35
    assert isinstance(fourier.alpha, Bump) and (fourier.alpha.at, fourier.alpha.width) == (372.75, 1.5)
    assert experiment.bodies["loaf"].temperature == 297.15 and experiment.bodies["loaf"].shape.base == (0.0, 0.004)
    assert experiment.output.every == 10.0 and isinstance(experiment.output.every, float)
    assert experiment.method.offset == (0.0, 0.0) and experiment.grid.directions == 2
    assert (experiment.name, experiment.path, experiment.moving) == ("experiment", None, False)


def test_defaults_that_follow(block):
    experiment = load(block)
    assert experiment.output.every == 0.001 and experiment.moving
    assert load(block, {"time.end": 1}).output.every == 0.01


def test_file_keeps_its_text_and_name(tmp_path, loaf):
    file = tmp_path / "my loaf.yaml"
    text = "# a comment\n" + json.dumps(loaf)
    file.write_text(text)
    experiment = load(file)
    assert (experiment.source, experiment.path, experiment.name) == (text, file, "my loaf")
    assert load(str(file)).key() == experiment.key() == load(loaf).key()


@pytest.mark.parametrize("scene", ["loaf", "block"])
def test_resolved_reads_back(scene, request):
    experiment = load(request.getfixturevalue(scene), {"surfaces": [], "exact": None})
    resolved = json.loads(json.dumps(experiment.resolved(), allow_nan=False))
    again = load(resolved)
    assert again == experiment and again.run_id == experiment.run_id and again.resolved() == resolved
    assert resolved["method"]["transfer"] == {"apic": {}} and resolved["time"]["safety"] == 1.0


def test_infinite_beta(loaf):
    loaf["surfaces"][0]["convection"]["beta"] = math.inf
    experiment = load(loaf)
    assert experiment.surfaces[0].convection.beta == math.inf
    assert load(json.loads(json.dumps(experiment.resolved(), allow_nan=False))) == experiment


def test_key_is_content(loaf):
    key, run_id = load(loaf).key(), load(loaf).run_id
    same = [
        {"title": "other"},
        {"grid.size": "[44 mm, 0.044]"},
        {"grid.cell": "1 mm"},
        {"kappa": "350 mW/m/K"},
        {"materials.dough.heat.fourier.kappa": {"constant": 0.35}},
        {"density": 301.0},
        {"method.transfer": "apic"},
        {"method.offset": [0, 0.0]},
        {"sweep": {"axes": {"kappa": [1, 2]}}},
        {"time.step": "auto"},
        {"output.probes": {"centre": [0.0, 0.0215]}},
    ]
    for change in same:
        assert load(loaf, change).key() == key, change
        assert load(loaf, change).run_id == run_id, change
    for change in [
        {"kappa": 0.36},
        {"method.precision": "float32"},
        {"output.every": 5},
        {"exact": {"robin_cylinder": {}}},
        {"method.offset": [0, 0.1]},
        {"density": 302},
    ]:
        assert load(loaf, change).run_id != run_id, change
    assert "method" not in key or key["method"] == {}
    assert "title" not in key and "walls" not in key


def test_default_walls_are_no_difference(block):
    del block["walls"]
    assert load(block).run_id == load({**block, "walls": {"left": "slip"}}).run_id != load({**block, "walls": {"left": "stick"}}).run_id


def test_kinds_without_parameters_as_a_word(block):
    block["method"] = {"transfer": "flip", "temperature": {"pic": None}}
    experiment = load(block)
    assert experiment.method.transfer.blend == 0.0 and experiment.method.temperature.kind == "pic" and experiment.walls["bottom"].kind == "stick"


def test_extends_merges_deeply(tmp_path, block):
    (tmp_path / "base.yaml").write_text(json.dumps(block))
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "middle.yaml").write_text("extends: ../base.yaml\ntime: {safety: 0.5}\nmaterials: {dough: {density: 900, flow: null}}\n")
    (tmp_path / "top.yaml").write_text("extends: sub/middle.yaml\nwalls: {bottom: slip, left: contact}\nmaterials: {dough: {elastic: {hencky: {nu: 0.2}}}}\n")
    experiment = load(tmp_path / "top.yaml")
    dough = experiment.materials["dough"]
    assert (dough.density, dough.flow, dough.elastic.nu, dough.elastic.E.value) == (900.0, None, 0.2, 1e4)
    assert (experiment.time.safety, experiment.time.end) == (0.5, 0.1)
    assert {side: wall.kind for side, wall in experiment.walls.items()} == {"bottom": "slip", "left": "contact"}


def test_extends_exchanges_a_kind(tmp_path, block):
    (tmp_path / "base.yaml").write_text(json.dumps({**block, "method": {"transfer": {"flip": {"blend": 0.1}}}}))
    (tmp_path / "top.yaml").write_text(
        "extends: base.yaml\nmethod: {transfer: {pic: {}}}\nbodies: {block: {shape: {ball: {centre: [0.05, 0.05], radius: 0.02}}}}\n"
    )
    experiment = load(tmp_path / "top.yaml")
    assert experiment.method.transfer.kind == "pic" and experiment.bodies["block"].shape.kind == "ball"


def test_overrides(loaf):
    given = {
        "κ": "0.4",
        "beta": ".inf",
        "time.end": "2 min",
        "grid.cell": 2e-3,
        "output.probes.crust": "[34 mm, 21.5 mm]",
        "alpha.bump.width": "2 degC",
        "method.rigid.implicit.order": "2",
        "gravity": None,
        "surfaces.0.side": "lateral",
        "title": "new",
    }
    experiment = load(loaf, given)
    fourier = experiment.materials["dough"].heat
    assert (fourier.kappa.value, fourier.alpha.width, experiment.time.end, experiment.grid.cell) == (0.4, 2.0, 120.0, 0.002)
    assert experiment.surfaces[0].convection.beta == math.inf and experiment.surfaces[0].side == "lateral"
    assert experiment.output.probes["crust"] == (0.034, 0.0215) and experiment.method.rigid.order == 2 and experiment.title == "new"


def test_override_exchanges_a_law_and_a_kind(loaf):
    experiment = load(loaf, {"materials.dough.heat.fourier.kappa.table": "{temperature: [300, 400], value: [0.2, 0.4]}", "alpha": "2800"})
    assert experiment.materials["dough"].heat.kappa.kind == "table" and experiment.materials["dough"].heat.alpha.value == 2800.0
    experiment = load({**loaf, "method": {"transfer": "apic"}}, {"method.transfer.flip.blend": 0.5})
    assert experiment.method.transfer.blend == 0.5


def test_named_surfaces(loaf):
    loaf["surfaces"] = [{**loaf["surfaces"][0], "side": "top", "name": "lid"}, {**loaf["surfaces"][0], "side": "bottom"}]
    experiment = load(loaf, {"surfaces.lid.convection.beta": 5, "surfaces.1.convection.beta": 6})
    assert [surface.convection.beta for surface in experiment.surfaces] == [5.0, 6.0]
    (problem,) = problems(loaf, {"beta": 5})
    assert problem.allowed == "surfaces.lid.convection.beta, surfaces.1.convection.beta"


def test_an_override_of_a_swept_parameter_fixes_it(loaf):
    loaf["sweep"] = {"axes": {"kappa": [0.2, 0.3], "beta": [5, 10]}, "zip": [{"density": [300, 310], "outside": [400, 410]}]}
    experiment = load(loaf, {"materials.dough.heat.fourier.kappa": 0.4, "density": 305})
    assert dict(experiment.sweep.axes) == {"beta": (5, 10)} and experiment.sweep.zip == ({"outside": (400, 410)},)
    assert load(loaf, {"kappa": 0.4, "beta": 1, "density": 3, "outside": 400}).sweep is None
    assert load(loaf, {"sweep.axes.kappa": "[0.25]"}).sweep.axes["kappa"] == (0.25,)
    loaf["sweep"] = {"sample": {"sobol": {"count": 4, "ranges": {"kappa": [0.2, 0.3]}}}, "points": [{"beta": 1}, {"beta": 2}]}
    assert load(loaf, {"kappa": 0.4}).sweep.sample is None
    assert load(loaf, {"beta": 0.4}).sweep.points == ()


def test_override_errors_name_the_option(loaf):
    found = problems(
        loaf, {"kapa": "1", "beta": "-1", "grid.cel": "3 s", "time.end": "x: y: z", "method.transfer.flip.blend": 2, "bodies.laof.temperature": 300}
    )
    assert {(one.file, one.line, one.column) for one in found} == {
        ("--set kapa=1", 0, 0),
        ("--set beta=-1", 0, 0),
        ("--set grid.cel=3 s", 0, 0),
        ("--set time.end=x: y: z", 0, 0),
        ("--set method.transfer.flip.blend=2", 0, 0),
        ("--set bodies.laof.temperature=300", 0, 0),
    }
    said = {one.file.split("=")[0][6:]: one for one in found}
    assert said["kapa"].suggestion == "'kappa'" and said["grid.cel"].suggestion == "'cell'" and said["bodies.laof.temperature"].suggestion == "'loaf'"
    assert str(said["beta"]).startswith("--set beta=-1: surfaces.0.convection.beta: the heat-transfer coefficient is out of range (given -1); allowed: ")


def test_smoke(loaf):
    loaf |= {"smoke": {"grid.cell": "4 mm", "time.end": 20, "kappa": 0.4}, "sweep": {"axes": {"kappa": [0.2, 0.3], "beta": [5, 10]}}}
    assert load(loaf).grid.cell == 1e-3
    experiment = load(loaf, {"time.end": 30}, smoke=True)
    assert (experiment.grid.cell, experiment.time.end) == (4e-3, 30.0) and dict(experiment.sweep.axes) == {"beta": (5, 10)}
    assert load(loaf).run_id == load({**loaf, "smoke": None}).run_id


def test_smoke_without_a_section_is_an_error(loaf):
    (problem,) = problems(loaf, smoke=True)
    assert problem.message == "the config has no smoke section"


def test_dict_errors(loaf):
    loaf["grid"]["cell"] = True
    loaf["time"]["end"] = float("nan")
    loaf["bodies"]["loaf"]["temperature"] = 10**400
    found = problems(loaf)
    assert [(one.file, one.line, one.path) for one in found] == [
        ("<dict>", 0, "grid.cell"),
        ("<dict>", 0, "bodies.loaf.temperature"),
        ("<dict>", 0, "time.end"),
    ]


def test_errors_and_experiments_cross_processes(loaf):
    assert pickle.loads(pickle.dumps(load(loaf))) == load(loaf)
    found = problems(loaf, {"kapa": 1})
    assert pickle.loads(pickle.dumps(ConfigError(found))).problems == found


def test_models_are_frozen(loaf):
    with pytest.raises(ValueError, match="frozen"):
        load(loaf).grid.cell = 1.0


def test_an_experiment_without_load(loaf):
    assert Experiment.model_validate(loaf).run_id == load(loaf).run_id


def test_a_named_pipe_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(ConfigError, match="it is a pipe"):
        load(tmp_path / "pipe.yaml")
