"""A map of failures: `stability:` names two axes, panels (methods), what counts as beyond, and the lines of theory. `mpm stability` draws it."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from mpm.config.base import Choice, Model, doc, problem
from mpm.config.condition import ConditionError
from mpm.config.formula import ALLOWED, Formula
from mpm.config.quantities import Number, Positive, Quantity, Whole
from mpm.config.sweep import Axis


def readable(text: str) -> str:
    """A formula that can be read."""
    try:
        Formula(text)
    except ConditionError as error:
        raise problem("formula", str(error), ALLOWED) from None
    return text


One = Annotated[dict[str, Axis], Field(min_length=1, max_length=1)]
Text = Annotated[str, Field(max_length=200)]


class TheoryLine(Model):
    """A line of theory on the map."""

    label: Text = doc(description="what the figure calls it")
    formula: Annotated[str, AfterValidator(readable)] = doc(description="y of x, in the units of the axes: 1/(1/0.49 + x/1.5)")
    source: Text = doc("", description="where the formula is from")
    panels: tuple[str, ...] = doc((), description="labels of the panels that it is for; all unless given")
    role: Annotated[Literal["expected", "safe"], Choice()] = doc("expected", description="expected: the boundary should lie on it; safe: never below it")


class Growth(Model):
    """A series whose growth is measured over the second half of a run."""

    of: str = doc(description="name of a series in the dataset: temperature_max, energy_kinetic")
    less: Number = doc(0.0, description="taken off the series first: its value at rest")


class Stability(Model):
    """Outcomes over two axes, past the limits. Along every column the boundary is bracketed on the given values and then refined."""

    across: One = doc(description="horizontal axis: one parameter and its values")
    along: One = doc(description="vertical axis, along which the boundary is sought: one parameter and its first values")
    panels: dict[str, dict[str, Any]] = doc({}, description="label: {parameter: value, ...}, a panel each")
    steps: Annotated[int, Whole("number of steps", 10, 10**6)] | None = doc(None, description="runs last this many of `along`, which then is a time step")
    frames: Annotated[int, Whole("number of frames", 4, 1000)] = doc(20, description="samples of the series in a run with `steps`")
    resolution: Annotated[float, Quantity("", "resolution", above=0, most=1)] = doc(0.02, description="relative width of the bracket at which to stop")
    toward: Annotated[Literal["larger", "smaller"], Choice()] = doc("larger", description="where along the vertical axis things fail")
    beyond: dict[str, Positive] = doc({}, description="final: a completed point is beyond where it exceeds this (error_temperature: 0.05)")
    growth: Growth | None = doc(None, description="a completed run is beyond the boundary where this series grows")
    names: Annotated[dict[Literal["across", "along"], Text], Field()] = doc({}, description="how the axes are called on the figure")
    lines: tuple[TheoryLine, ...] = doc((), description="lines of theory that the figure draws")
