"""Tally: the points of a plan, which of them are missing, and how they are counted."""

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from mpm.records.provenance import source_hash
from mpm.records.variables import FAILED, KILLED, OK, STATUS, TIMEOUT

EXIT = {"interrupted": 130, "terminated": 143, "budget": 75}


@dataclass
class Points:
    """The points of a plan by run id: equal points are one."""

    cases: dict[str, Any]
    total: int
    counts: Counter = field(default_factory=Counter)

    @classmethod
    def of(cls, plan: Any) -> "Points":
        cases: dict[str, Any] = {}
        for case in plan.cases:
            cases.setdefault(case.run_id, case)
        return cls(cases, len(plan.cases), Counter(case.run_id for case in plan.cases))


def missing(points: Points, lines: dict[str, dict], rerun: str | None) -> list[str]:
    """Run ids that are to run, in the plan's order."""
    source = source_hash() if rerun == "stale" else ""

    def due(run_id: str) -> bool:
        line = lines.get(run_id)
        if line is None or rerun == "all":
            return True
        return (rerun == "failed" and line["status"] != OK) or (rerun == "stale" and line["source"] != source)

    return [run_id for run_id in points.cases if due(run_id)]


def counts(points: Points, lines: dict[str, dict], skipped: int) -> dict[str, int]:
    """Points by status; equal points count each."""
    found = Counter({name: 0 for name in STATUS})
    for run_id, times in points.counts.items():
        found[STATUS[lines[run_id]["status"]] if run_id in lines else "pending"] += times
    found["skipped"] += skipped
    return dict(found)


def exit_code(found: dict[str, int], stopped: str) -> int:
    """interface.md section 2."""
    if stopped in EXIT:
        return EXIT[stopped]
    bad = sum(found[STATUS[status]] for status in (FAILED, TIMEOUT, KILLED)) + found["diverged"]
    if stopped == "broken":
        return 1
    return 0 if not bad else 4 if not found["ok"] and not found["pending"] else 3
