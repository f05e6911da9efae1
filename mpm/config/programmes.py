"""Temperatures over time: a number, or one of the kinds by which it may change (an oven programme).

Table   values over times, linear or PCHIP between them, constant outside       `outside: {table: {time: [0, 600], value: [20 degC, 190 degC]}}`
Sine    mean + amplitude sin(2 pi t/period + phase)

After validation a constant is a float, anything else one of these classes.
"""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import model_validator
from pydantic_core import core_schema

from mpm.config.base import Choice, Kind, Menu, doc, problem
from mpm.config.laws import Law
from mpm.config.quantities import Angle, Quantity, Temperature, TemperatureDifference, Time

Moment = Annotated[float, Quantity("s", "time")]


class TimeTable(Kind):
    """Values over increasing times, constant before and after."""

    kind: ClassVar[str] = "table"
    time: tuple[Moment, ...] = doc(description="increasing times", min_length=2)
    value: tuple[Temperature, ...] = doc(description="temperature at each time")
    interpolation: Annotated[Literal["linear", "pchip"], Choice()] = doc("linear", description="between the entries: straight lines, or monotone cubics")

    @model_validator(mode="after")
    def shape(self) -> "TimeTable":
        """As many values as times, times increasing."""
        if len(self.time) != len(self.value):
            raise problem("table", f"{len(self.time)} times but {len(self.value)} values", "lists of the same length", at=("value",))
        for index, (low, high) in enumerate(zip(self.time, self.time[1:], strict=False)):
            if high <= low:
                raise problem("table", "times must increase", "each above the one before", at=("time", index + 1))
        return self


class Sine(Kind):
    """mean + amplitude sin(2 pi t/period + phase)."""

    kind: ClassVar[str] = "sine"
    mean: Temperature = doc(description="temperature in the middle")
    amplitude: TemperatureDifference = doc(description="half of the swing")
    period: Time = doc(description="time of one swing")
    phase: Angle = doc(0.0, description="phase at the start")

    @model_validator(mode="after")
    def above_zero(self) -> "Sine":
        """No temperature below absolute zero."""
        if self.amplitude >= self.mean:
            raise problem("sine", "the temperature would fall below absolute zero", f"below {self.mean:g} [K]", at=("amplitude",))
        return self


class ProgrammeMenu(Law):
    """Annotation of a temperature that is a number or changes over time."""

    def __init__(self, quantity: Quantity):
        Menu.__init__(self, f"programme of the {quantity.name}", TimeTable, Sine)
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


Programme = Annotated[float | TimeTable | Sine, ProgrammeMenu(Quantity("K", "temperature", above=0))]
