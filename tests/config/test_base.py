"""Menus: adding a kind is one class and one entry of a list."""

from typing import ClassVar

import pytest
from pydantic import ValidationError

from mpm.config.base import Kind, Model, one_of
from mpm.config.bodies import SHAPES
from mpm.config.boundary import WALLS
from mpm.config.materials import ELASTIC, EXPANSION, FLOW, HEAT
from mpm.config.numerics import RIGID, TRANSFERS
from mpm.config.output import EXACT
from mpm.config.schema_paths import Slot, places
from mpm.config.sweep import DESIGNS

MENUS = (SHAPES, WALLS, ELASTIC, EXPANSION, FLOW, HEAT, RIGID, TRANSFERS, EXACT, DESIGNS)


class Round(Kind):
    kind: ClassVar[str] = "round"
    radius: float = 1.0


class Square(Kind):
    kind: ClassVar[str] = "square"
    side: float


class Holder(Model):
    shape: one_of("shape", Round, Square)
    other: one_of("shape", Round, Square) | None = None


def test_a_kind_by_its_key_its_name_or_its_model():
    for said in ({"round": {}}, {"round": None}, "round", Round()):
        assert Holder.model_validate({"shape": said}).shape == Round()
    assert Holder.model_validate({"shape": {"square": {"side": 2}}, "other": None}).shape == Square(side=2.0)


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ("square", "needs its parameters"),
        ("triangle", "unknown shape 'triangle'"),
        ({"triangle": {}}, "unknown shape 'triangle'"),
        ({}, "found none"),
        ({"round": {}, "square": {"side": 1}}, "found 'round' and 'square'"),
        (3, "expected a mapping with one key that names the shape"),
        (None, "expected a mapping with one key that names the shape"),
        ({"round": {"side": 1}}, "Extra inputs"),
        ({"square": 3}, "Input should be a valid dictionary"),
    ],
)
def test_refused(said, message):
    with pytest.raises(ValidationError, match=message):
        Holder.model_validate({"shape": said})


def test_slots_know_kinds():
    slot = Slot(Holder)
    assert slot.keys == ["shape", "other"] and slot.step("other").keys == ["round", "square"]
    assert slot.walk(("other", "square", "side")).type is float and slot.walk(("other", "triangle")) is None
    assert list(places(slot, "side")) == ["shape.square.side", "other.square.side"]


@pytest.mark.parametrize("menu", MENUS, ids=lambda menu: menu[0].__name__)
def test_menus(menu):
    assert len({kind.kind for kind in menu}) == len(menu)
    for kind in menu:
        assert kind.kind.isidentifier() and kind.__doc__ and kind.model_config["extra"] == "forbid" and kind.model_config["frozen"]
