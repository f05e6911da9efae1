"""What varies: `sweep: {axes, zip, sample, points, derive, where}`. Values are checked against the parameter they are for, when the points are planned."""

from typing import Annotated, Any, ClassVar

from pydantic import Field
from pydantic_core import core_schema

from mpm.config.base import Kind, Model, doc, one_of, problem
from mpm.config.quantities import Fraction, Whole

Count = Annotated[int, Whole("count", 1, 10**9)]
Seed = Annotated[int, Whole("seed", 0, 2**63 - 1)]


class Range:
    """Annotation of a range: `[first, last]` or, for even steps of the logarithm, `{log: [first, last]}`; with `count` a third entry."""

    def __init__(self, *words: str, entries: int):
        self.words = words
        self.entries = entries

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict:
        ends = "first, last" + ", count" * (self.entries - 2)
        spaced = {"type": "array", "minItems": self.entries, "maxItems": self.entries, "description": f"[{ends}]"}
        plain = spaced if self.entries == 2 else {"type": "array", "minItems": 1, "description": "a list of values"}
        return {"anyOf": [plain, *({"type": "object", "properties": {word: spaced}, "required": [word], "additionalProperties": False} for word in self.words)]}

    @property
    def allowed(self) -> list[str]:
        """The forms, as a user writes them."""
        entries = ", ".join(["first", "last", "count"][: self.entries])
        plain = "[first, last]" if self.entries == 2 else "a list of values"
        return [plain, *(f"{{{word}: [{entries}]}}" for word in self.words)]

    def validate(self, value: Any) -> Any:
        """A tuple of values, or a mapping of one word to a tuple of the right length."""
        if isinstance(value, list | tuple):
            if not value:
                raise problem("axis", "the list is empty, so there would be no points", self.allowed)
            if self.entries == 2 and len(value) != 2:
                raise problem("axis", f"a range has two ends, found {len(value)} values", self.allowed)
            return tuple(value)
        if not isinstance(value, dict):
            raise problem("axis", "expected a list of values or a range", self.allowed)
        unknown = [key for key in value if key not in self.words]
        if unknown:
            raise problem("axis", f"unknown kind of range {unknown[0]!r}", list(self.words), at=(unknown[0],))
        if len(value) != 1:
            raise problem("axis", "expected exactly one kind of range", self.allowed)
        ((word, entries),) = value.items()
        if not isinstance(entries, list | tuple) or len(entries) != self.entries:
            raise problem("axis", f"expected {self.entries} entries", self.allowed, at=(word,))
        if self.entries == 3 and (isinstance(entries[2], bool) or not isinstance(entries[2], int) or entries[2] < 1):
            raise problem("axis", "the count must be a whole number, at least 1", self.allowed, at=(word, 2))
        return {word: tuple(entries)}


Axis = Annotated[Any, Range("linear", "log", entries=3)]
Span = Annotated[Any, Range("log", entries=2)]
Values = Annotated[tuple[Any, ...], Field(min_length=1)]


class Design(Kind):
    """A sample of several parameters at once; the same seed gives the same points."""

    count: Count = doc(description="number of points")
    seed: Seed = doc(0, description="the same seed gives the same points")
    ranges: dict[str, Span] = doc(min_length=1, description="parameter: [first, last] or {log: [first, last]}")


class Sobol(Design):
    """Scrambled Sobol sequence; a longer sample with the same seed begins with the same points."""

    kind: ClassVar[str] = "sobol"


class Latin(Design):
    """Latin hypercube."""

    kind: ClassVar[str] = "latin"


class Halton(Design):
    """Scrambled Halton sequence; a longer sample with the same seed begins with the same points."""

    kind: ClassVar[str] = "halton"


class Uniform(Design):
    """Independent uniform numbers."""

    kind: ClassVar[str] = "uniform"


class Saltelli(Design):
    """Saltelli's design for first and total indices: count base rows of parameters + 2 points each."""

    kind: ClassVar[str] = "saltelli"


DESIGNS: tuple[type[Kind], ...] = (Sobol, Latin, Halton, Uniform, Saltelli)


class Refine(Model):
    """New points between the axes' own, where the answer bends, crosses a level, or ok meets failed."""

    of: str = doc(description="the observable that decides: its final value, as temperature_centre or time_to_centre_95_degC")
    level: float | str | None = doc(None, description="follow where the observable crosses this value, as 95 degC; where it bends unless given")
    until: Fraction = doc(0.01, description="how well it is to be known: of the ranges where a level or failures are followed, else of the observable's spread")
    points: Count = doc(200, description="most points, with the axes' own")


class Sweep(Model):
    """The points of a sweep: the product of all axes, zips, the sample and the list of points, without what `where` drops."""

    axes: dict[str, Axis] = doc({}, description="parameter: list of values, {linear: [first, last, count]} or {log: [first, last, count]}")
    zip: tuple[dict[str, Values], ...] = doc((), description="parameters that move together, one dimension an entry")
    sample: one_of("design", *DESIGNS) | None = doc(None, description="points spread over ranges of several parameters: one dimension, `sample`")
    points: tuple[dict[str, Any], ...] = doc((), description="an explicit list of points")
    derive: dict[str, str] = doc({}, description="parameter: formula over others, in SI numbers, as in 'beta / kappa * 0.02'")
    refine: Refine | None = doc(None, description="more points where an observable changes most, or crosses a level")
    where: str | None = doc(None, description="a condition on swept parameters; points that fail it are skipped")
