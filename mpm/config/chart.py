"""What `mpm chart` draws: methods, and along what each is refined. Every setting is the config with a few parameters set, as `--set` does it."""

from typing import Annotated, Any

from pydantic import Field

from mpm.config.base import Model, doc
from mpm.config.quantities import Positive, Whole

Refined = Annotated[tuple[Any, ...], Field(min_length=1)]
Paths = dict[str, dict[str, Refined]]


class ChartMethod(Model):
    """One method."""

    set: dict[str, Any] = doc({}, description="parameter: value, what makes the method")
    refine: Paths | None = doc(None, description="as chart.refine, for this method alone")


class Chart(Model):
    """Error against time over methods and resolutions."""

    error: tuple[str, ...] = doc((), description="finals that are the error, the largest counts: error_l2, ...; the exact solution says, unless given")
    scale: Positive | None = doc(
        None, description="what counts as 100 % of an error or of the observables; the range of temperatures, the largest change of what moves unless given"
    )
    observables: tuple[str, ...] = doc(
        (), description="without `exact`: observables that are compared with their limit by Richardson extrapolation; all of output unless given"
    )
    reference: str | None = doc(None, description="the method whose finest settings give that limit; the first unless given")
    repeats: Annotated[int, Whole("rounds", 1, 1000)] = doc(5, description="rounds of timing; five or more for a figure")
    methods: dict[str, ChartMethod] = doc({}, description="methods by name; by the physics of the config unless given")
    refine: Paths = doc({}, description="name of a path of refinement: {parameter: values from coarse to fine, which move together}")
