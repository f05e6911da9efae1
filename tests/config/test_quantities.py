"""Quantities: floats in SI, bounds, what is refused."""

import math
from typing import get_args

import pytest
from pydantic import TypeAdapter, ValidationError

from mpm.config import quantities
from mpm.config.quantities import Quantity, Whole

MENU = {name: get_args(item)[1] for name, item in vars(quantities).items() if len(get_args(item)) == 2 and isinstance(get_args(item)[1], Quantity)}


@pytest.mark.parametrize("name", MENU)
def test_every_quantity(name):
    quantity = MENU[name]
    inside = 0.25
    assert quantity.validate(inside) == inside and type(quantity.validate(0 if quantity.least == 0 else 1)) is float
    unit = quantity.unit or "%"
    scale = 1.0 if quantity.unit else 0.01
    assert quantity.validate(f"0.5 {unit}") == pytest.approx(0.5 * scale)
    for wrong in (True, None, [], {}, "1", "x", "1 lightyear**5", math.nan, -math.inf, 10**400, "1 A"):
        with pytest.raises(Exception, match=r".+") as caught:
            quantity.validate(wrong)
        assert type(caught.value).__name__ == "PydanticCustomError", (name, wrong)
    assert quantity.name and isinstance(quantity.wanted, str)


def test_infinity_only_where_it_means_something():
    assert quantities.LENGTH.infinite is False
    beta = get_args(quantities.Exchange)[1]
    assert beta.validate(math.inf) == beta.validate(".inf") == beta.validate("inf") == math.inf
    assert [name for name, quantity in MENU.items() if quantity.infinite] == ["Exchange"]


def test_offset_units():
    assert TypeAdapter(quantities.Temperature).validate_python("20 degC") == 293.15
    assert TypeAdapter(quantities.TemperatureDifference).validate_python("20 degC") == 20.0
    with pytest.raises(ValidationError, match="out of range"):
        TypeAdapter(quantities.Temperature).validate_python("-274 degC")


def test_minus_zero_is_zero():
    assert math.copysign(1, quantities.LENGTH.validate(-0.0)) == 1


def test_auto():
    step = TypeAdapter(quantities.TimeOrAuto)
    assert step.validate_python("auto") == "auto" and step.validate_python("2 ms") == 0.002
    with pytest.raises(ValidationError):
        step.validate_python("automatic")


def test_whole():
    whole = Whole("count", 1, 5)
    assert whole.validate(2.0) == 2 and type(whole.validate(2.0)) is int
    for wrong in (0, 6, 2.5, True, "2", None, math.nan, math.inf):
        with pytest.raises(Exception, match="the count is"):
            whole.validate(wrong)


def refusal(quantity, value):
    with pytest.raises(Exception, match=r".+") as caught:
        quantity.validate(value)
    return caught.value.context


@pytest.mark.parametrize(
    ("value", "suggestion"), [(-5.0, '"-5 degC"'), (0.0, '"0 degC"'), (-273.0, '"-273 degC"'), (-274.0, ""), ("-300 degC", ""), ("0 K", "")]
)
def test_a_temperature_below_zero_was_meant_in_degrees_where_there_are_such(value, suggestion):
    found = refusal(MENU["Temperature"], value)
    assert "out of range" in found["message"] and found["suggestion"] == suggestion


def test_what_is_no_temperature_is_not_taken_for_degrees():
    assert refusal(MENU["Length"], -5.0)["suggestion"] == "" and refusal(MENU["Temperature"], "5 V")["suggestion"] == ""
    assert refusal(MENU["Temperature"], "5 C")["suggestion"] == '"5 degC"' and refusal(MENU["Length"], "5 C")["suggestion"] == ""


def test_infinity_has_a_sign():
    exchange = get_args(quantities.Exchange)[1]
    assert "must be finite" in refusal(exchange, -math.inf)["message"] and "must be finite" in refusal(MENU["Length"], math.inf)["message"]


def test_units_as_datasets_write_them():
    units = {name: quantity.units for name, quantity in MENU.items()}
    assert units["Length"] == "m" and units["Exchange"] == "W/m2/K" and all(units.values())
    assert {quantity.units for quantity in MENU.values() if not quantity.unit} == {"1"}
