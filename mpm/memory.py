"""What a run has to remember so that it can be cut anywhere and go on with the same bits.

A memory is plain data: nested dicts with text keys, lists, text, numbers, None, and arrays. Runs make and take it; where it is kept is not their
business (mpm.records.checkpoint). They ask a keeper, which is None where nobody wants to keep anything:

    keeper.found        the memory of the same run, cut earlier; None to start from the start
    keeper.due(stop)    whether to save now: some time has passed since the last, or the run is told to stop
    keeper.save(memory)
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


@dataclass
class Turn:
    """The keeper of one of several runs that a point makes one after another. On the way to the one that was cut, those before it run again."""

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
