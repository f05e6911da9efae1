"""How far what meets has entered each other: next to nothing where a gap closes, which the impulses see to; but a tool that comes, or a body that grows, within
another is pushed apart at PUSH of the speed of sound only (solve.py), with a force that says nothing of either, and an energy that no load gives.
"""

from collections.abc import Iterator

import numpy as np

from mpm.contact.found import BODY
from mpm.warned import warning

ENTERED = 0.2  # cells


def look(met) -> None:
    """Keep the largest overlap of each body with what it meets (B, K)."""
    np.maximum(met.entered, met.touching.deepest, out=met.entered)


def warned(met) -> Iterator[str]:
    """A warning for every body or tool that has entered another, or a wall."""
    B, found = len(met.names), {}
    for b, to in np.argwhere(met.entered > ENTERED * met.space.h):
        other = to - BODY
        name = met.sides[to] if to < BODY else met.names[other] if other < B else met.tool_names[other - B]
        pair = (met.names[b], name) if not 0 <= other < b else (name, met.names[b])
        found[pair] = max(found.get(pair, 0.0), met.entered[b, to] / met.space.h)
    for (one, name), deep in found.items():
        yield warning("overlap", f"{one} and {name} overlapped by {deep:.2g} cells, and were pushed apart")
