"""The points of a plan, which of them are missing, and how they are counted."""

import json
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from mpm.records.provenance import source_hash
from mpm.records.variables import FAILED, KILLED, OK, STATUS, TIMEOUT
from mpm.sweep.ids import Ids, raw
from mpm.sweep.summaries import Summaries
from mpm.warned import KINDS, counted

EXIT = {"interrupted": 130, "terminated": 143, "budget": 75}


class Points:
    """The points of a plan by run id: equal points are one. `times` says how often each stands in the plan."""

    def __init__(self, plan: Any):
        texts = getattr(plan.cases, "ids", None)
        texts = raw(case.run_id for case in plan.cases) if texts is None else texts
        first, times = np.unique(texts, return_index=True, return_counts=True)[1:]
        alone = len(first) == len(texts)
        kept = np.argsort(first)
        self.first = None if alone else first[kept]  # the place in the plan of the first of equal points
        self.times = np.ones(len(texts), np.int8) if alone else times[kept]
        self.ids = Ids(texts if alone else texts[self.first])
        self.cases, self.total = ById(self.ids, plan.cases, self.first), len(plan.cases)

    @classmethod
    def of(cls, plan: Any) -> "Points":
        """Those of a plan."""
        return cls(plan)


class ById(Mapping):
    """Cases by run id, in the order of the plan."""

    def __init__(self, ids: Ids, cases: Any, first: np.ndarray | None):
        self.ids, self.listed, self.first = ids, cases, first

    def __getitem__(self, run_id: str) -> Any:
        number = self.ids.find(run_id)
        if number < 0:
            raise KeyError(run_id)
        return self.listed[number if self.first is None else int(self.first[number])]

    def __contains__(self, run_id: object) -> bool:
        return run_id in self.ids

    def __iter__(self) -> Iterator[str]:
        return iter(self.ids)

    def __len__(self) -> int:
        return len(self.ids)


class Configs:
    """Configs of points as workers get them, JSON text, made ahead while those are busy."""

    def __init__(self, points: Points):
        self.points = points
        self.ready: dict[str, str] = {}

    def make(self, run_ids: Iterable[str]) -> None:
        """Make those of the points that come next."""
        self.ready |= {run_id: self.take(run_id) for run_id in run_ids if run_id not in self.ready}

    def take(self, run_id: str) -> str:
        """That of a point."""
        return self.ready.pop(run_id, "") or json.dumps(self.points.cases[run_id].experiment.resolved())


class Due:
    """Points to hand out: those of the plan by number, and around them those that are due again."""

    def __init__(self, ids: Ids, numbers: np.ndarray):
        self.ids, self.numbers, self.at = ids, numbers, 0
        self.front: deque[str] = deque()
        self.back: deque[str] = deque()

    def __len__(self) -> int:
        return len(self.front) + len(self.numbers) - self.at + len(self.back)

    def __iter__(self) -> Iterator[str]:
        yield from self.front
        yield from (self.ids[number] for number in self.numbers[self.at :])
        yield from self.back

    def __contains__(self, run_id: object) -> bool:
        return any(run_id == one for one in self)

    @property
    def first(self) -> str:
        """The next."""
        return self.front[0] if self.front else self.ids[self.numbers[self.at]] if self.at < len(self.numbers) else self.back[0]

    def take(self) -> str:
        """The next, which is not due any more."""
        if self.front:
            return self.front.popleft()
        if self.at < len(self.numbers):
            self.at += 1
            return self.ids[self.numbers[self.at - 1]]
        return self.back.popleft()


def missing(points: Points, lines: Summaries, rerun: str | None) -> np.ndarray:
    """Numbers of the points that are to run, in the plan's order. `lines` are of these points."""
    assert lines.ids is points.ids
    there = lines.rows["there"]
    if rerun == "all":
        return np.arange(len(there))
    again = np.zeros(len(there), bool)
    if rerun == "failed":
        again = lines.rows["status"] != OK
    elif rerun == "stale":
        again[stale(lines)] = True
    return np.flatnonzero(~there | again)


def stale(lines: Summaries) -> np.ndarray:
    """Numbers of the points that other source made."""
    return np.flatnonzero(lines.rows["there"] & (lines.rows["source"] != lines.code(source_hash())))


def counts(points: Points, lines: Summaries, skipped: int) -> dict[str, int]:
    """Points by status; equal points count each."""
    assert lines.ids is points.ids
    there = lines.rows["there"]
    found = np.bincount(lines.rows["status"][there], weights=points.times[there], minlength=len(STATUS))
    told = {name: int(count) for name, count in zip(STATUS, found, strict=True)}
    told["pending"] += int(points.times[~there].sum())
    told["skipped"] += skipped
    return told


def warned(points: Points, lines: Summaries) -> dict[str, int]:
    """Points that are ok and have warnings: all of them under "points", then how many have each kind."""
    there = lines.rows["there"] & (lines.rows["status"] == OK)
    found: Counter = Counter()
    for code, times in zip(*count_each(lines.rows["warned"][there], points.times[there]), strict=True):
        kinds = lines.texts[code].split()
        found.update(dict.fromkeys(kinds, int(times)) | ({"points": int(times)} if kinds else {}))
    return {name: found[name] for name in ("points", *KINDS) if found[name]}


def count_each(codes: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Different codes, and how many points have each."""
    used, place = np.unique(codes, return_inverse=True)
    return used, np.bincount(place, weights=times, minlength=len(used))


def counts_in_words(found: dict[str, int], warnings: dict[str, int]) -> str:
    """Counts in words: `32 ok, 9 of them with warnings: volume 7, temperature 4`."""
    parts = [f"{count} {name}" for name, count in found.items() if count]
    if warnings:
        kinds = counted({name: count for name, count in warnings.items() if name != "points"})
        parts[0] += f", {warnings['points']} of them with warnings: {kinds}" + (";" if len(parts) > 1 else "")
    return ", ".join(parts).replace(";,", ";")


def exit_code(found: dict[str, int], stopped: str) -> int:
    """Exit code of a sweep: README.md, "From the shell"."""
    if stopped in EXIT:
        return EXIT[stopped]
    bad = sum(found[STATUS[status]] for status in (FAILED, TIMEOUT, KILLED)) + found["diverged"]
    if stopped == "broken":
        return 1
    return 0 if not bad else 4 if not found["ok"] and not found["pending"] else 3
