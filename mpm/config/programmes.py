"""Quantities over time: a number, or one of the kinds by which it may change (an oven programme).

Table   values over times, linear, PCHIP or smooth between them, constant outside       `outside: {table: {time: [0, 600], value: [20 degC, 190 degC]}}`
        `smooth` is a ramp, 3 s^2 - 2 s^3 of each step at s of its time         `gravity: [{table: {time: [0, 2], value: [0, 9.81], interpolation: smooth}}]`
        two values at one time are a jump                                       `beta: {table: {time: [0, 600, 600, 900], value: [10, 10, 40, 40]}}`
Sine    mean + amplitude sin(2 pi t/period + phase)

After validation a constant is a float, anything else one of these classes.
"""

import math
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import model_validator
from pydantic_core import core_schema

from mpm.config.base import Choice, Kind, Menu, doc, problem
from mpm.config.laws import Law, of_unit
from mpm.config.quantities import Angle, Quantity, Time

Moment = Annotated[float, Quantity("s", "time")]


class TimeTable(Kind):
    """Values over increasing times, constant before and after; two values at one time are a jump."""

    kind: ClassVar[str] = "table"
    time: tuple[Moment, ...] = doc(description="increasing times; the same time twice is a jump from the first value to the second", min_length=2)
    value: tuple[float, ...] = doc(description="value at each time")
    interpolation: Annotated[Literal["linear", "pchip", "smooth"], Choice()] = doc(
        "linear", description="between the entries: straight lines, monotone cubics, or ramps 3 s^2 - 2 s^3 that are level at each entry"
    )

    @model_validator(mode="after")
    def shape(self) -> "TimeTable":
        """As many values as times, times increasing or equal in pairs."""
        if len(self.time) != len(self.value):
            raise problem("table", f"{len(self.time)} times but {len(self.value)} values", "lists of the same length", at=("value",))
        for index, (low, high) in enumerate(zip(self.time, self.time[1:], strict=False)):
            if high < low:
                raise problem("table", "times must increase", "each above the one before, or the same twice for a jump", at=("time", index + 1))
            if high == low and index and self.time[index - 1] == low:
                raise problem("table", "the same time three times", "two values at a jump", at=("time", index + 1))
        return self


class Sine(Kind):
    """mean + amplitude sin(2 pi t/period + phase)."""

    kind: ClassVar[str] = "sine"
    mean: float = doc(description="value in the middle")
    amplitude: float = doc(description="half of the swing")
    period: Time = doc(description="time of one swing")
    phase: Angle = doc(0.0, description="phase at the start")
    least: ClassVar[tuple[float, str, str]] = (-math.inf, "", "")  # what is too low, words, unit

    @model_validator(mode="after")
    def above_least(self) -> "Sine":
        """Nothing below what the quantity may be."""
        least, said, unit = self.least
        low = self.mean - self.amplitude
        if low < least or (low == least and unit == "K"):
            raise problem("sine", said, f"below {self.mean - least:g}" + (f" [{unit}]" if unit else ""), at=("amplitude",))
        return self


class ProgrammeMenu(Law):
    """Annotation of a quantity that is a number or changes over time."""

    def __init__(self, quantity: Quantity):
        finite = replace(quantity, infinite=False)
        least = 0.0 if quantity.above == 0 else quantity.least
        swing = Annotated[float, Quantity(quantity.unit, f"{quantity.name} difference" if quantity.unit == "K" else quantity.name, above=0, difference=True)]
        one = Annotated[float, finite]
        table = of_unit(TimeTable, quantity, globals(), value=(tuple[one, ...], doc(description="value at each time")))
        sine = of_unit(Sine, quantity, globals(), mean=(one, doc(description="value in the middle")), amplitude=(swing, doc(description="half of the swing")))
        said = f"the {quantity.name} would fall below {'absolute zero' if quantity.unit == 'K' else f'{least:g}'}"
        sine.least = least, said, quantity.unit  # type: ignore[attr-defined]  # of_unit gives a class derived from Sine
        Menu.__init__(self, f"programme of the {quantity.name}", table, sine)
        self.quantity = quantity

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        def read(value: Any, kinds: Any) -> Any:
            named = isinstance(value, str) and value in self.kinds
            return kinds(value) if named or isinstance(value, dict | Kind) else self.quantity.validate(value)

        return core_schema.no_info_wrap_validator_function(read, super().__get_pydantic_core_schema__(source, handler))

    def check(self, value: Any) -> Any:
        """A mapping names its kind."""
        return Menu.check(self, value)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        number = self.quantity.__get_pydantic_json_schema__(schema, handler)
        return {**number, "anyOf": [*number["anyOf"], *Menu.__get_pydantic_json_schema__(self, schema, handler)["oneOf"]]}


def programme(quantity: Quantity) -> Any:
    """The type of a quantity that may change over time."""
    return Annotated[float | TimeTable | Sine, ProgrammeMenu(quantity)]


Programme = programme(Quantity("K", "temperature", above=0))
Beta = programme(Quantity("W/m**2/K", "heat-transfer coefficient", least=0, infinite=True))
FluxProgramme = programme(Quantity("W/m**2", "heat flux"))
FrictionProgramme = programme(Quantity("", "coefficient of friction", least=0, infinite=True))
Gravity = programme(Quantity("m/s**2", "acceleration"))
EmissivityProgramme = programme(Quantity("", "emissivity", least=0, most=1))
VelocityProgramme = programme(Quantity("m/s", "velocity"))
RateProgramme = programme(Quantity("m**3/s", "volume rate", least=0))
