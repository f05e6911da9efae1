"""The points of a plan and the dimensions they stand on, as plain data; `cases` and `settings` make them."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mpm.config.experiment import Experiment
from mpm.config.variation import label


@dataclass(frozen=True)
class Coordinate:
    """Values of one varied parameter along a dimension: floats in SI, or labels."""

    name: str
    values: np.ndarray
    units: str
    long_name: str
    config_path: str


@dataclass(frozen=True)
class Dimension:
    """A dimension of the dataset. An axis has one coordinate, named as itself; a zip, a sample and a list of points may have several."""

    name: str
    size: int
    coords: list[Coordinate]


class Case:
    """One point: its run id (the hash of its content); its place, what is set, and its experiment, each made when asked for."""

    __slots__ = ("flat", "maker", "run_id")

    def __init__(self, maker: Any, flat: int, run_id: str):
        self.maker, self.flat, self.run_id = maker, flat, run_id

    @property
    def index(self) -> tuple[int, ...]:
        """Its place in the dimensions."""
        return self.maker.index(self.flat)

    @property
    def values(self) -> dict[str, Any]:
        """What the sweep sets, by path; what follows from it is left out."""
        return self.maker.values(self.flat)

    @property
    def words(self) -> dict[str, str]:
        """The same for people: short names, and values that no other point of the dimension has in the same letters."""
        return self.maker.words(self.flat)

    @property
    def experiment(self) -> Experiment:
        """The config of the point: some 0.1 ms."""
        return self.maker.experiment(self.flat)


@dataclass(frozen=True)
class Alone:
    """The maker of one point that is at hand already, as that of an experiment without a sweep."""

    whole: Experiment
    place: tuple[int, ...] = ()
    told: dict[str, Any] = field(default_factory=dict)

    def index(self, flat: int) -> tuple[int, ...]:
        """Its place in the dimensions."""
        return self.place

    def values(self, flat: int) -> dict[str, Any]:
        """What is set."""
        return self.told

    def words(self, flat: int) -> dict[str, str]:
        """What is set, for people."""
        return {path.rsplit(".", 1)[-1]: label(value) for path, value in self.told.items()}

    def experiment(self, flat: int) -> Experiment:
        """The experiment itself."""
        return self.whole


class CaseList(Sequence):
    """Cases of one maker by their places, each made when asked for: 24 bytes a point. `ids` holds the run ids as bytes."""

    def __init__(self, maker: Any, flats: np.ndarray, ids: np.ndarray):
        self.maker, self.flats, self.ids = maker, flats, ids

    def __len__(self) -> int:
        return len(self.flats)

    def __getitem__(self, at: Any) -> Any:
        if isinstance(at, slice):
            return CaseList(self.maker, self.flats[at], self.ids[at])
        return Case(self.maker, int(self.flats[at]), self.ids[at].decode("ascii"))


@dataclass(frozen=True)
class Cases:
    """All points of a sweep; `skipped` is true where the condition drops one, and those have no case."""

    dims: tuple[Dimension, ...] = ()
    cases: Sequence[Case] = ()
    skipped: np.ndarray = field(default_factory=lambda: np.zeros((), dtype=bool))
    derived: tuple[tuple[tuple[str, ...], Coordinate], ...] = ()  # what follows by a formula: the dimensions it has, and its values there

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the dimensions."""
        return tuple(dim.size for dim in self.dims)

    def __len__(self) -> int:
        return len(self.cases)


def swept_paths(plan: Any) -> list[str]:
    """Config paths of everything that varies."""
    coordinates = [coordinate for dim in plan.dims for coordinate in dim.coords] + [coordinate for _, coordinate in plan.derived]
    return [coordinate.config_path for coordinate in coordinates if coordinate.config_path]


def skipped(plan: Any) -> int:
    """Points that `where` dropped."""
    total = 1
    for dim in plan.dims:
        total *= dim.size
    return total - len(plan.cases)
