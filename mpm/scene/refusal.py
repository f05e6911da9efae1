"""The error of a config that is valid but that no method here can run, and its place in the config."""

import functools
from collections.abc import Callable
from typing import Any


class SceneError(ValueError):
    """A valid config that no method here can run: the path in the config that is to be changed, and what to change. `within` finds its line."""

    def __init__(self, at: tuple, message: str, place: str = ""):
        super().__init__(at, message, place)
        self.at, self.message, self.place = at, message, place

    def __str__(self) -> str:
        return self.place or f"{'.'.join(map(str, self.at))}: {self.message}"

    def within(self, experiment: Any) -> "SceneError":
        """The same with file, line and column, where the experiment knows its text."""
        from mpm.config.explain import Finding, problem

        tree = getattr(experiment, "_tree", None)
        found = problem(tree, Finding(self.at, self.message, on_key=True)) if tree is not None and not self.place else None
        return SceneError(self.at, self.message, str(found)) if found is not None else self


def placed(compute: Callable) -> Callable:
    """`compute(experiment, ...)` whose refusals tell their place."""

    @functools.wraps(compute)
    def with_place(experiment, *given, **named):
        try:
            return compute(experiment, *given, **named)
        except SceneError as error:
            raise error.within(experiment) from None

    return with_place
