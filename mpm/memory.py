"""What a run has to remember so that it can be cut anywhere and go on with the same bits.

A memory is plain data: nested dicts with text keys, lists, text, numbers, None, and arrays. Runs make and take it; where it is kept is not their
business (mpm.records.checkpoint). They ask a keeper, which is None where nobody wants to keep anything:

    keeper.found        the memory of the same run, cut earlier; None to start from the start
    keeper.due(stop)    whether to save now: some time has passed since the last, or the run is told to stop
    keeper.save(memory)
    keeper.frames       where its snapshots go, if the keeper has a place for them: `Frames` or what does the same
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np


def arrays(tree: Any, path: str = "") -> dict[str, np.ndarray]:
    """Every array in nested (named) tuples that a run may change, by the path to it."""
    if isinstance(tree, np.ndarray):
        return {path: tree} if tree.flags.writeable else {}
    found: dict[str, np.ndarray] = {}
    if isinstance(tree, tuple):
        for name, part in zip(getattr(tree, "_fields", range(len(tree))), tree, strict=True):
            found |= arrays(part, f"{path}.{name}" if path else str(name))
    return found


def fill(tree: Any, found: dict[str, np.ndarray]) -> None:
    """Put arrays back where `arrays` found them."""
    for path, array in arrays(tree).items():
        array[...] = found[path]


def rows(values: list) -> np.ndarray:
    """Numbers, or arrays of one shape, as one array: thousands of small ones would be dear to keep."""
    return np.array(values)


class Frames:
    """Snapshots of a run, in memory: (time [s], fields on the grid, fields of particles) each. A keeper may bring others (mpm.records.frames)."""

    def __init__(self):
        self.held: list[tuple[float, dict, dict]] = []

    @property
    def times(self) -> np.ndarray:
        """When they were taken [s]."""
        return np.array([when for when, _, _ in self.held])

    def add(self, when: float, grid: dict, particles: dict) -> None:
        """One more."""
        self.held.append((when, grid, particles))

    def drop(self) -> None:
        """Take back the last."""
        self.held.pop()

    def clear(self) -> None:
        """Begin again."""
        self.held.clear()

    def memory(self) -> Any:
        """Plain data from which `recall` has them again."""
        return [{"time": when, "grid": grid, "particles": particles} for when, grid, particles in self.held]

    def recall(self, found: Any) -> None:
        """As they were when `memory` was kept."""
        self.held = [(frame["time"], frame["grid"], frame["particles"]) for frame in found]


@dataclass
class Turn:
    """The keeper of one of several runs that a point makes one after another. On the way to the one that was cut, those before it run again.

    It has no place for snapshots: these runs hold theirs in memory, and in the checkpoint.
    """

    keeper: Any
    number: int
    found: Any = field(init=False)

    def __post_init__(self) -> None:
        before = self.keeper.found
        self.found = before["memory"] if before is not None and before["turn"] == self.number else None

    def due(self, stop: bool) -> bool:
        return self.keeper.due(stop)

    def save(self, memory: Any) -> None:
        self.keeper.save({"turn": self.number, "memory": memory})
