"""The JSON Schema: valid in itself, accepts the shipped configs, knows kinds and units."""

import json
import math
from pathlib import Path

import pytest

from mpm.config import schema
from mpm.config.base import Menu
from mpm.config.experiment import Experiment
from mpm.config.nodes import Origin, read
from mpm.config.schema_paths import Slot, leaves

SHIPPED = sorted((Path(__file__).parents[2] / "configs").rglob("*.yaml"))


def deref(part, root):
    return root["$defs"][part["$ref"].rsplit("/", 1)[1]] if "$ref" in part else part


def accepts(part, value, root) -> bool:
    """As much of JSON Schema as ours uses."""
    part = deref(part, root)
    if any(
        key in part and not test(accepts(inner, value, root) for inner in part[key]) for key, test in (("anyOf", any), ("oneOf", lambda found: sum(found) == 1))
    ):
        return False
    if ("enum" in part and value not in part["enum"]) or ("const" in part and value != part["const"]):
        return False
    kinds = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int, "boolean": bool, "null": type(None)}
    if "type" in part and (not isinstance(value, kinds[part["type"]]) or (isinstance(value, bool) and part["type"] in ("number", "integer"))):
        return False
    if isinstance(value, dict):
        known, rest = part.get("properties", {}), part.get("additionalProperties", True)
        if any(key not in value for key in part.get("required", ())):
            return False
        return all(
            accepts(known[key], item, root) if key in known else (rest if isinstance(rest, bool) else accepts(rest, item, root)) for key, item in value.items()
        )
    if isinstance(value, list):
        return part.get("minItems", 0) <= len(value) <= part.get("maxItems", len(value)) and all(accepts(part.get("items", {}), item, root) for item in value)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return part.get("minimum", value) <= value <= part.get("maximum", value) and value > part.get("exclusiveMinimum", -math.inf)
    return True


def test_every_reference_is_there():
    made = schema()
    text = json.dumps(made)
    assert made["$schema"].endswith("2020-12/schema") and "x-unit" not in text
    for name in {part.split('"')[0] for part in text.split("#/$defs/")[1:]}:
        assert name in made["$defs"]


@pytest.mark.parametrize("scene", ["loaf", "block"])
def test_accepts_right_and_refuses_wrong(scene, request):
    made, data = schema(), request.getfixturevalue(scene)
    data |= {
        "extends": "base.yaml",
        "method": {"transfer": "apic", "rigid": {"implicit": {"order": 2}}, "heat_step": "auto"},
        "sweep": {"axes": {"kappa": [1, 2], "beta": {"log": [1, 2, 3]}}},
    }
    assert accepts(made, data, made)
    heat = data["materials"]["dough"]["heat"]["fourier"]
    for wrong in (-1, True, {"table": {"temperature": [1, 2]}}, {"bump": {"base": 1, "heat": 1, "at": 1, "width": 1, "x": 1}}, {}, {"constant": {"value": 1}}):
        assert not accepts(made, {**data, "materials": {"dough": {"density": 1, "heat": {"fourier": {**heat, "kappa": wrong}}}}}, made), wrong
    assert not accepts(made, {**data, "tiem": 1}, made)
    assert not accepts(made, {**data, "method": {"transfer": "flop"}}, made)


@pytest.fixture(scope="module")
def made():
    return schema()


@pytest.fixture(scope="module")
def validator(made):
    """Of another's hand; that the schema is one is checked first."""
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft202012Validator.check_schema(made)
    return jsonschema.Draft202012Validator(made)


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_accepts_what_is_shipped(file, made):
    root, problems = read(file.read_text(encoding="utf-8"), Origin(file.name))
    assert not problems
    assert accepts(made, root.plain(), made)


@pytest.mark.parametrize("file", SHIPPED, ids=lambda file: file.stem)
def test_independent_validator(file, validator):
    validator.validate(read(file.read_text(encoding="utf-8"), Origin(file.name))[0].plain())


def test_units_and_kinds_are_described():
    made = schema()
    assert made["$defs"]["Grid"]["properties"]["cell"]["description"] == "edge of a cell [m]"
    kinds = made["$defs"]["Body"]["properties"]["shape"]["oneOf"]
    assert [next(iter(kind["properties"])) for kind in kinds if "properties" in kind] == ["box", "ball", "cylinder", "ring", "polygon", "mesh", "point"]
    assert made["$defs"]["Convection"]["properties"]["beta"]["description"].endswith("[W/m**2/K]")


def test_every_menu_is_in_the_schema(block):
    text = json.dumps(schema())
    for _, slot in leaves(Slot(Experiment), Experiment.model_validate(block)):
        if isinstance(slot.menu, Menu):
            for name in slot.menu.kinds:
                assert f'"required": ["{name}"]' in text, name
