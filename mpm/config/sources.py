"""Sources: heat from within a body (microwaves, fermentation), and a force by its mass, over place, time and temperature."""

import ast
from typing import Annotated, Any, ClassVar

from pydantic import model_validator

from mpm.config.base import Kind, Menu, doc, problem
from mpm.config.boundary import Spell, ended
from mpm.config.condition import ConditionError, Formula
from mpm.config.programmes import ProgrammeMenu, Sine, TimeTable
from mpm.config.quantities import Quantity

PLACES = {0: (), 1: ("x",), 2: ("x", "y"), "axisymmetric": ("r", "z"), 3: ("x", "y", "z")}  # of the material at the start, by grid.dimension
KINDS = ("heat", "heat_by_mass", "force")


class ByFormula(Kind):
    """`{formula: "1e5*exp(-x/0.02)*sin(2*pi*t)"}`: over the place at the start x, y, z (r, z where round) [m], time t [s] and temperature T [K]."""

    kind: ClassVar[str] = "formula"
    text: str = doc(description="over x, y, z (r, z where round) of the material at the start [m], time t [s] and temperature T [K]")

    @classmethod
    def written(cls, made: dict, handler: Any) -> dict:
        """The text alone, right below the kind's name."""
        text = handler.resolve_ref_schema(super().written(made, handler))["properties"]["text"]
        return {**text, "description": cls.__doc__}

    @model_validator(mode="before")
    @classmethod
    def right_below(cls, value: Any) -> Any:
        """The text lies right under the kind's name."""
        return {"text": value} if not isinstance(value, dict) else value

    @model_validator(mode="after")
    def read(self) -> "ByFormula":
        """It is one."""
        try:
            Numerical(self.text)
        except ConditionError as error:
            raise problem("formula", str(error), "+ - * / **, numbers, pi, functions and x, y, z, t, T", at=("text",)) from None
        return self


class Numerical(Formula):
    """A formula that holds numbers alone."""

    def check(self, node: ast.AST) -> None:
        """No text, no `not`."""
        for one in ast.walk(node):
            if isinstance(one, ast.Not) or (isinstance(one, ast.Constant) and isinstance(one.value, str)):
                raise ConditionError(f"a formula may not hold {'not' if isinstance(one, ast.Not) else str(one.value)[:60]!r}: it gives a number")


class SourceMenu(ProgrammeMenu):
    """Annotation of a quantity that is a number, changes over time, or is a formula."""

    def __init__(self, quantity: Quantity):
        super().__init__(quantity)
        Menu.__init__(self, f"source of the {quantity.name}", *self.kinds.values(), ByFormula)


def source(unit: str, name: str) -> Any:
    """The type of what a source gives."""
    return Annotated[float | TimeTable | Sine | ByFormula, SourceMenu(Quantity(unit, name))]


HeatByVolume = source("W/m**3", "heat source")
HeatByMass = source("W/kg", "heat source by mass")
Push = source("m/s**2", "force by mass")


class Source(Spell):
    """What acts within a body; several on one body add up."""

    of: str = doc(description="a name under bodies")
    heat: HeatByVolume | None = doc(None, description="heat by volume of the undeformed body; negative cools; a number, over time, or by a formula")
    heat_by_mass: HeatByMass | None = doc(None, description="heat by mass; negative cools; a number, over time, or by a formula")
    force: tuple[Push, ...] | None = doc(None, description="force by mass (an acceleration), one entry a direction")

    @model_validator(mode="after")
    def lasts(self) -> "Source":
        """It ends after it began."""
        return ended(self)

    @model_validator(mode="after")
    def gives(self) -> "Source":
        """Something."""
        if all(getattr(self, key) is None for key in KINDS):
            raise problem("source", "the entry does not say what it gives", list(KINDS))
        return self
