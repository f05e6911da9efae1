"""Quantities: floats in SI that a config may write as numbers or as text with a unit.

`Length`, `Temperature`, ... are `Annotated[float, Quantity(...)]`. A plain number is SI. Text needs a unit of the right dimension ("2 mm", "190 degC").
`Temperature` is a point on a scale (degC is shifted by 273.15); `TemperatureDifference` is a width or a rise (degC is not shifted).
Infinity is refused except where it means something, NaN always.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic_core import core_schema

from mpm.config.base import problem

INFINITE = {"inf", ".inf", "infinity"}
SCALE = 1e40  # products of seven such numbers are still numbers, and nothing that is measured lies beyond it or below its inverse


@dataclass(frozen=True)
class Quantity:
    """A number with a unit, a name and bounds.

    unit        SI unit, as pint and the dataset write it; "" for a pure number
    name        what it is, for errors: "length"
    above, least, most   exclusive lower, inclusive lower, inclusive upper bound
    infinite    whether +inf is meaningful
    difference  whether an offset unit (degC) means a difference
    """

    unit: str
    name: str
    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf
    infinite: bool = False
    difference: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        number: dict[str, Any] = {"type": "number"}
        for key, bound in (("exclusiveMinimum", self.above), ("minimum", self.least), ("maximum", self.most)):
            if math.isfinite(bound):
                number[key] = bound
        text: dict[str, Any] = {"type": "string", "description": f'a number and a unit, like "1 {self.unit or "%"}"'}
        return {"anyOf": [number, text], "description": self.name, "x-unit": self.unit or "1"}

    @property
    def units(self) -> str:
        """The unit as datasets write it: W/m2/K, and 1 for a pure number."""
        return self.unit.replace("**", "") or "1"

    @property
    def wanted(self) -> str:
        """What would be right, in words: `a number above 0 [K] or text with a unit, like "2 K"`."""
        bounds = [f"above {self.above:g}"] * math.isfinite(self.above) + [f"at least {self.least:g}"] * math.isfinite(self.least)
        bounds += [f"at most {self.most:g}"] * math.isfinite(self.most)
        text = "a number" + (" " + " and ".join(bounds) if bounds else "") + (f" [{self.unit}]" if self.unit else "")
        return text + (" or .inf" if self.infinite else "") + (f', or text with a unit such as "1 {self.unit}"' if self.unit else "")

    def validate(self, value: Any) -> float:
        """The value as an SI float within bounds; raises the error that a user reads."""
        if type(value) is float and self.above < value <= self.most and self.least <= value and 1 / SCALE <= abs(value) <= SCALE:
            return value
        plain = not isinstance(value, str)
        if isinstance(value, str):
            value = self.read(value)
        elif isinstance(value, bool) or not isinstance(value, int | float):
            said = "nothing" if value is None else {bool: "true or false", dict: "a mapping"}.get(type(value), "a list")
            raise problem("quantity", f"expected a {self.name}, found {said}", self.wanted)
        try:
            number = float(value)
        except OverflowError:
            raise problem("quantity", f"the {self.name} is too large for a floating-point number", self.wanted) from None
        if math.isnan(number):
            raise problem("quantity", f"the {self.name} is not a number (NaN)", self.wanted)
        if math.isinf(number) and not (self.infinite and number > 0):
            raise problem("quantity", f"the {self.name} must be finite", self.wanted)
        if number <= self.above or number < self.least or number > self.most:
            hint = f'"{value:g} degC"' if plain and self.unit == "K" and not self.difference and number > -273.15 else ""
            raise problem("quantity", f"the {self.name} is out of range", self.wanted, suggestion=hint)
        if number and not 1 / SCALE <= abs(number) <= (math.inf if self.infinite else SCALE):
            raise problem("quantity", f"the {self.name} is out of all scale", f"{'0, or ' * (self.above < 0)}{1 / SCALE:g} to {SCALE:g} [{self.unit or 1}]")
        return number + 0.0  # -0.0 and 0.0 are one value, and so one run

    def read(self, text: str) -> float:
        """Convert text with a unit; loads pint."""
        if self.infinite and text.strip().lower() in INFINITE:
            return math.inf
        from mpm.config.units import UnitError, convert

        try:
            return convert(text, self.unit, self.name, self.difference)
        except UnitError as error:
            raise problem("unit", str(error), self.wanted, suggestion=error.suggestion) from None


@dataclass(frozen=True)
class Auto:
    """Annotation of a field that is the word `auto` or a quantity."""

    quantity: Quantity

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(lambda value: value if value == "auto" else self.quantity.validate(value))

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        inner = self.quantity.__get_pydantic_json_schema__(schema, handler)
        return {**inner, "anyOf": [{"const": "auto"}, *inner["anyOf"]]}


@dataclass(frozen=True)
class Whole:
    """Annotation of a whole number within bounds; 2.0 is 2, true is not 1."""

    name: str
    least: int
    most: int

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        return {"type": "integer", "minimum": self.least, "maximum": self.most}

    def validate(self, value: Any) -> int:
        """The value as an int."""
        wanted = f"a whole number from {self.least} to {self.most}"
        if isinstance(value, bool) or not isinstance(value, int | float) or value != value // 1:
            raise problem("whole", f"the {self.name} is not a whole number", wanted)
        if not self.least <= value <= self.most:
            raise problem("whole", f"the {self.name} is out of range", wanted)
        return int(value)


LENGTH = Quantity("m", "length")
TIME = Quantity("s", "time", above=0)

Length = Annotated[float, Quantity("m", "length", above=0)]
PerLength = Annotated[float, Quantity("1/m", "surface to volume ratio", above=0)]
Coordinate = Annotated[float, LENGTH]
Time = Annotated[float, TIME]
TimeOrAuto = Annotated[float | str, Auto(TIME)]
Angle = Annotated[float, Quantity("rad", "angle")]
AngularVelocity = Annotated[float, Quantity("rad/s", "angular velocity")]
Velocity = Annotated[float, Quantity("m/s", "velocity")]
Density = Annotated[float, Quantity("kg/m**3", "density", above=0)]
Temperature = Annotated[float, Quantity("K", "temperature", above=0)]
TemperatureDifference = Annotated[float, Quantity("K", "temperature difference", above=0, difference=True)]
Modulus = Annotated[float, Quantity("Pa", "modulus", above=0)]
Pressure = Annotated[float, Quantity("Pa", "pressure")]
Exchange = Annotated[float, Quantity("W/m**2/K", "heat-transfer coefficient", least=0, infinite=True)]
PerKelvin = Annotated[float, Quantity("1/K", "expansion per kelvin", difference=True)]
StressPerKelvin = Annotated[float, Quantity("Pa/K", "stress per kelvin", difference=True)]
Fraction = Annotated[float, Quantity("", "fraction", least=0, most=1)]
Positive = Annotated[float, Quantity("", "number", above=0)]
Number = Annotated[float, Quantity("", "number")]
