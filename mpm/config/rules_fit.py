"""Rules for named parameters."""

import keyword
from collections.abc import Iterator
from typing import Any

from mpm.config.condition import FUNCTIONS
from mpm.config.explain import Finding
from mpm.config.rules_scene import plain_names


def parameters(experiment: Any) -> Iterator[Finding]:
    """Their names are words of formulas."""
    yield from plain_names(experiment, "parameters", experiment.parameters)
    for name in experiment.parameters:
        if name in (*FUNCTIONS, "pi") or keyword.iskeyword(name):
            yield Finding(("parameters", name), f"{name!r} means something else in formulas", f"another name, as {name}_0", on_key=True)
