"""What the points of a sweep have in common and where they differ, for `mpm plan`: their physics, what they cost, which of them would be refused."""

import importlib
import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from mpm.scene.refusal import SceneError
from mpm.sweep import engine

KNOWN, COSTED = 1000, 5  # points, evenly spread with the ends, whose physics is told; whose cost is
NUMBER = re.compile(r"(?<=\()[-+.\de]+(?=[ )])")  # of a pair of bodies: its friction, its conductance


def spread(points: Any, due: np.ndarray, most: int) -> Iterator[Any]:
    """Experiments of at most so many of the points that would run."""
    for place in np.unique(np.linspace(0, len(due) - 1, min(most, len(due))).round().astype(int)):
        yield points.cases[points.ids[due[place]]].experiment


def told_together(points: Any, due: np.ndarray) -> dict[str, list[str]]:
    """The physics of all points in one: what only some have with their number, numbers that differ by their ends."""
    runner = importlib.import_module(engine.RUNNER)
    found = [runner.physics(one) for one in spread(points, due, KNOWN)]
    kinds: dict[str, Counter[str]] = {}
    for one in found:
        for text in one["compiled"]:
            kinds.setdefault(NUMBER.sub("#", text), Counter())[text] += 1
    compiled = [joined(texts) + among(sum(texts.values()), len(found)) for _, texts in sorted(kinds.items())]
    parts = Counter(text for one in found for text in one["absent"])
    absent = [text + ("" if times == len(found) else among(times, len(found))) for text, times in parts.items() if times == len(found) or " " in text]
    return {"compiled": compiled, "absent": absent}


def joined(texts: Counter[str]) -> str:
    """One text for those that differ in numbers alone."""
    first = next(iter(texts))
    columns = [sorted(set(column), key=float) for column in zip(*(NUMBER.findall(text) for text in texts), strict=True)]
    ends = iter(column[0] if len(column) == 1 else f"{column[0]} to {column[-1]}" for column in columns)
    return NUMBER.sub(lambda _: next(ends), first)


def among(times: int, count: int) -> str:
    """In how many points of those that were looked at, unless in all."""
    return "" if times == count else f" (in {times} of {count} points)"


def costs(points: Any, due: np.ndarray, first: dict[str, Any]) -> dict[str, Any]:
    """Least and most seconds, mean of seconds and of bytes written, most memory, of COSTED points; `refused`: what is said of those that cannot run."""
    runner, known, refused = importlib.import_module(engine.RUNNER), [first], []
    for one in list(spread(points, due, COSTED))[1:]:
        try:
            known.append(runner.estimate(one))
        except SceneError as error:
            refused.append(str(error))
    seconds = [one["seconds"] for one in known]
    return {
        "points": len(known),
        "least": min(seconds),
        "most": max(seconds),
        "seconds": float(np.mean(seconds)),
        "output_bytes": float(np.mean([one["output_bytes"] for one in known])),
        "memory_bytes": max(one["memory_bytes"] for one in known),
        "refused": refused,
    }
