"""Status: what a sweep's folder holds, without opening a single result (each point's seal carries its summary)."""

import re
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.netcdf import summary
from mpm.records.variables import STATUS
from mpm.sweep.api import folder_plan
from mpm.sweep.case_list import skipped
from mpm.sweep.lock import owner, said_owner
from mpm.sweep.queue import counts, counts_in_words, stale, warned
from mpm.sweep.report import label
from mpm.warned import KINDS

SLOWEST = 5


def status(out: Path) -> dict[str, Any]:
    """Counts by status, failures grouped by reason, slowest points, points from other source, who works here, seconds of work and of waiting left."""
    store, plan, points, about, lines, damaged = folder_plan(out)
    found, warnings = counts(points, lines, skipped(plan)), warned(points, lines)
    reasons: dict[str, list[str]] = defaultdict(list)
    for number in lines.by_status(ok=False):
        reasons[reason(lines[points.ids[number]])].append(points.ids[number])
    ok = lines.by_status(ok=True)
    took = lines.rows["wall_time"][ok]
    slow = [points.ids[number] for number in ok[np.argsort(-took, kind="stable")[:SLOWEST]]]
    mean = float(took.mean()) if len(took) else None
    left, who = mean * found["pending"] if mean is not None else None, owner(store.out)
    begun = {path.stem for path in (store.out / "checkpoints").glob("*.checkpoint")}
    return {
        "out": str(out),
        "name": about["name"],
        "points": sum(found.values()),
        "counts": found,
        "warnings": warnings,
        "warned": [{"kind": kind, "count": warnings[kind], "advice": KINDS[kind]} | first_with(kind, points, lines) for kind in warnings if kind in KINDS],
        "stale": sorted(points.ids[number] for number in stale(lines)),
        "damaged": damaged,
        "failures": [
            {"reason": why, "count": len(ids), "example": label(points.cases[ids[0]])} | {name: lines[ids[0]][name] for name in ("error", "advice", "run_id")}
            for why, ids in sorted(reasons.items(), key=lambda item: -len(item[1]))
        ],
        "slowest": [{"point": label(points.cases[run_id]), "seconds": lines[run_id]["wall_time"], "run_id": run_id} for run_id in slow],
        "seconds_a_point": mean,
        "seconds_of_work_left": left,
        "seconds_left": left / who["jobs"] if left is not None and who and who.get("jobs") else None,
        "begun": sorted(begun.intersection(points.cases)),
        "owner": who,
        "dataset": str(store.dataset) if store.dataset.exists() else None,
        "run": summary(store.out / "run.nc"),
    }


def first_with(kind: str, points: Any, lines: Any) -> dict[str, str]:
    """The first point that is ok and has a warning of this kind."""
    codes = [code for code, text in enumerate(lines.texts) if kind in text.split()]
    ok = lines.by_status(ok=True)
    run_id = points.ids[ok[np.isin(lines.rows["warned"][ok], codes)][0]]
    return {"example": label(points.cases[run_id]), "run_id": run_id}


def reason(line: dict) -> str:
    """What failures are grouped by: the status and the kind of outcome, or the text up to its first number."""
    if line["outcome"]:
        return f"{STATUS[line['status']]}: {line['outcome'].replace('_', ' ')}"
    text = re.sub(r" \([\w.]+:\d+\)$", "", line["error"])
    cut = next((i for i, letter in enumerate(text) if letter.isdigit()), len(text))
    return text[:cut].rstrip(" (=,") or text


def in_words(found: dict[str, Any]) -> str:
    """The same in words."""
    words = [
        f"{found['out']}: {found['name']}, {found['points']} point{'s' if found['points'] != 1 else ''}: {counts_in_words(found['counts'], found['warnings'])}"
    ]
    for row in found["warned"]:
        words.append(f"  {row['count']} x warning: {row['kind']}, as {row['example'] or 'the point'}; {row['advice']}")
    for failure in found["failures"]:
        words.append(f"  {failure['count']} x {failure['reason']}, as {failure['example'] or 'the point'}: {failure['error']}")
        if failure["advice"]:
            words.append(f"      {failure['advice']}")
    if (run := found["run"]) is not None:
        words.append(f"  run.nc: one point, {run['error'] or STATUS[run['status']]}, {run['steps']} steps, {run['wall_time']:.3g} s")
    if found["stale"]:
        words.append(f"  {len(found['stale'])} from other source (--rerun stale runs them again)")
    if found["damaged"]:
        words.append(f"  {len(found['damaged'])} damaged (the next sweep runs them again)")
    if found["slowest"]:
        words.append("  slowest: " + ", ".join(f"{row['point'] or 'the point'} {row['seconds']:.3g} s" for row in found["slowest"]))
    if found["owner"] is not None:
        words.append(f"  being swept by {said_owner(found['owner'])}")
    if found["begun"]:
        words.append(f"  {len(found['begun'])} begun, with a checkpoint to go on from")
    if found["counts"]["pending"] and found["seconds_of_work_left"] is not None:
        workers = f", {found['seconds_left']:.3g} s with {found['owner']['jobs']} workers" if found["seconds_left"] is not None else ""
        words.append(f"  work left: {found['seconds_of_work_left']:.3g} s of one core{workers}")
    return "\n".join(words)
