"""Every key of a config is described and has an example, and every example is one: the models read it, and so does the schema."""

import functools
from typing import get_args, get_origin

import pytest
from pydantic import create_model

from mpm.config import schema
from mpm.config.base import Model
from mpm.config.examples import FIELDS, NAMES, UNITS, example
from mpm.config.experiment import Experiment
from mpm.config.schema_paths import Slot


@functools.cache
def models():
    """All classes of configs, and the menus on the way."""
    found, left = set(), [Slot(Experiment)]
    while left:
        slot = left.pop()
        if slot.menu:
            left += [Slot(kind) for kind in slot.menu.kinds.values()]
        elif slot.model and slot.model not in found:
            found.add(slot.model)
            left += filter(None, (slot.step(name) for name in slot.model.model_fields))
        elif get_origin(slot.type) is dict:
            left.append(slot.step(""))
        elif get_origin(slot.type) is tuple and get_args(slot.type):
            left.append(slot.step(0))
    return found


KEYS = sorted(((model, name) for model in models() for name in model.model_fields if Slot(model).step(name)), key=lambda key: (key[0].__name__, key[1]))


def test_the_walk_finds_the_whole_config():
    assert len(KEYS) > 350


@pytest.mark.parametrize("model, name", KEYS, ids=lambda value: value if isinstance(value, str) else value.__name__)
def test_a_key_is_described_and_its_example_is_read(model, name):
    field = model.model_fields[name]
    assert len(field.description or "") > 3 and model.__doc__
    shown = example(model.__name__, name, Slot(model).step(name), tuple(base.__name__ for base in model.__mro__))
    alone = create_model("Alone", __base__=Model, **{name: (field.annotation, field)})
    alone.model_validate({name: shown})


def test_the_tables_of_examples_name_what_there_is():
    owners = {f"{base.__name__}.{name}" for model, name in KEYS for base in model.__mro__} | {name for _, name in KEYS}
    assert set(FIELDS) <= owners
    quantities = [found.quantity for model, name in KEYS if (found := Slot(model).step(name)) and found.quantity]
    assert {one.unit for one in quantities} <= set(UNITS) and set(NAMES) <= {one.name for one in quantities}


def test_the_schema_describes_and_exemplifies_every_property():
    def properties(part):
        if isinstance(part, dict):
            yield from part.get("properties", {}).items()
            for key, inner in part.items():
                if key not in ("examples", "default"):
                    yield from properties(inner)
        elif isinstance(part, list):
            for inner in part:
                yield from properties(inner)

    made = schema()
    made.pop("anyOf")  # what is required unless the config extends another
    found = list(properties(made))
    assert len(found) > 500
    assert {name for name, part in found if not part.get("description")} == set()
    assert {name for name in made["properties"] if "examples" not in made["properties"][name]} == set()
    assert made["$defs"]["Method"]["properties"]["transfer"]["default"] == "apic" and made["$defs"]["Grid"]["properties"]["cell"]["examples"] == ["2 mm"]
