"""Reporter: what an engine tells while it works. This one says nothing; `cli` has those that talk."""

from typing import Any


class Reporter:
    """Silent. Subclasses override what they care about; none may raise or ask."""

    def start(self, total: int, done: int, jobs: int) -> None:
        """A sweep begins: points in all, points that are there already, workers."""

    def beat(self, running: dict[str, float]) -> None:
        """Fractions of the points that run now, by run id."""

    def finished(self, label: str, line: dict, again: bool) -> None:
        """A point has a record. `label` names it for people (`kappa=0.2 beta=5`); `again`: it will be tried once more."""

    def compiling(self, text: str, expected: float) -> None:
        """A kernel is compiled: what is done of it and what is left; `expected` seconds in all. Empty when it is ready."""

    def note(self, text: str) -> None:
        """Something worth a line."""

    def close(self) -> None:
        """No more will come."""


def label(case: Any) -> str:
    """A point's swept values, short: `kappa=0.35 beta=13.1`."""
    return " ".join(f"{name}={value}" for name, value in case.words.items())
