"""Verify: every file of a folder against its checksum; what is damaged is set aside, and its points run again.

Checked   each point's file, each batch, sweep.nc, run.nc, checkpoints and experiment.json: every byte of them is under a SHA-256
Aside     a damaged file becomes `<name>.damaged`, nothing is deleted; a dataset is made anew from the points, a checkpoint's run starts from its start
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.frames import Entries
from mpm.records.netcdf import DamagedFile, set_aside, unseal
from mpm.sweep.api import collect_last, folder_plan, run_engine
from mpm.sweep.background_collect import Gather
from mpm.sweep.engine import Engine, Options
from mpm.sweep.folder import signals
from mpm.sweep.lock import Refused, lock_where_possible
from mpm.sweep.queue import Due
from mpm.sweep.report import Reporter
from mpm.sweep.store import BATCH, Store


@dataclass
class Found:
    """What came of it. `sound`: all that is there now is as it was written, or was made again."""

    out: Path
    files: int = 0
    bytes: int = 0
    damaged: list[dict] = field(default_factory=list)  # file, what, why, aside
    left: int = 0  # half-written files that were removed
    due: list[str] = field(default_factory=list)  # points to run again
    lost: int = 0  # damaged files of points that the folder's experiment does not have (any more)
    ran: int = 0
    stopped: str = ""

    @property
    def sound(self) -> bool:
        """Nothing is damaged any more."""
        return not self.stopped and all(one["aside"] for one in self.damaged) and self.ran == len(self.due)

    def document(self) -> dict[str, Any]:
        """As plain JSON."""
        return {"sound": self.sound, **vars(self)}


def files(out: Path) -> Iterator[tuple[str, Path]]:
    """(kind, path) of every file that carries a checksum."""
    yield from (("experiment", path) for path in (out / "experiment.json",) if path.exists())
    yield from (("dataset", path) for path in (out / "sweep.nc", out / "run.nc") if path.exists())
    yield from (("series", path) for path in sorted((out / "series").glob("*.nc")))
    yield from (("point", path) for path in sorted((out / "points").glob("*/*.nc")))
    yield from (("frames", path) for path in sorted((out / "points").glob("*/*.frames")))
    yield from (("batch", path) for path in sorted((out / "batches").glob("*/*.nc")))
    yield from (("checkpoint", path) for path in sorted([*(out / "checkpoints").glob("*.checkpoint"), *out.glob("run.checkpoint")]))


def wrong(kind: str, path: Path) -> tuple[int, str]:
    """(bytes, what is wrong with a file; nothing where it is as it was written and lies where it belongs)."""
    if kind == "frames":
        return path.stat().st_size, frames_wrong(path)
    data = path.read_bytes()
    try:
        if kind == "experiment":
            Store(path.parent).experiment()
            return len(data), ""
        _, line = unseal(data, path)
    except (DamagedFile, Refused):
        return len(data), "its contents do not match its checksum"
    if kind == "point" and line.get("run_id") != path.stem:
        return len(data), f"it holds the point {line.get('run_id')}"
    return len(data), ""


def frames_wrong(path: Path) -> str:
    """What is wrong with a file of frames, which are looked at one by one."""
    try:
        frames = Entries(path)
        for k in range(len(frames)):
            frames[k]
    except DamagedFile:
        return "its contents do not match their checksums"
    return ""


def verify(out: Path, options: Options | None = None, reporter: Reporter | None = None, check: bool = False) -> Found:
    """Check all files of a folder; unless `check`, set aside what is damaged, run its points again, and bring the dataset up to date."""
    out, options, reporter = Path(out), options or Options(), reporter or Reporter()
    if not any(True for _ in files(out)):
        raise Refused(f"{out} holds no results; give the folder that `mpm sweep` or `mpm run` wrote")
    found = Found(out)
    with lock_where_possible(out, jobs=options.jobs) as writable:
        if not writable and not check:
            reporter.note(f"{out} cannot be written: it is only looked at")
        check = check or not writable
        found.left = 0 if check else Store(out).tidy()
        for kind, path in files(out):
            size, why = wrong(kind, path)
            found.files, found.bytes = found.files + 1, found.bytes + size
            if why:
                found.damaged.append({"file": str(path.relative_to(out)), "what": kind, "why": why, "aside": ""})
        if found.damaged and not check:
            repair(out, found, options, reporter)
    return found


def repair(out: Path, found: Found, options: Options, reporter: Reporter) -> None:
    """Set aside, and run again what was in it."""
    about_lost = any(one["what"] == "experiment" for one in found.damaged)
    if about_lost:  # without it nobody knows which points belong together; the points themselves are found by their ids
        for one in found.damaged:
            aside(out, one)
        found.stopped = "what the folder holds is not known any more: run `mpm sweep CONFIG --out` on it, which finds the points that are there"
        return
    if not (out / "experiment.json").exists():  # it was never there: an older `mpm run` wrote none
        for one in found.damaged:
            aside(out, one)
        found.stopped = "the same `mpm run` makes run.nc again"
        return
    run_lost = any(one["file"] == "run.nc" for one in found.damaged)
    run_alone = (out / "run.nc").exists() and not any(one["file"] == "sweep.nc" for one in found.damaged)
    store, plan, points, *_ = folder_plan(out)
    for one in [one for one in found.damaged if one["what"] == "frames"]:  # without them the point's own file is not whole either
        point = Path(one["file"]).with_suffix(".nc")
        if (out / point).exists() and not any(other["file"] == str(point) for other in found.damaged):
            found.damaged.append({"file": str(point), "what": "point", "why": "its frames are damaged", "aside": ""})
    names = [Path(one["file"]).stem if one["what"] == "point" else BATCH + Path(one["file"]).stem for one in found.damaged if one["what"] in ("point", "batch")]
    there = store.places(list(points.ids))
    held = {run_id for run_id, name in there.items() if name in set(names)}
    found.lost = sum(one["what"] == "point" and Path(one["file"]).stem not in points.cases for one in found.damaged)
    unsaid = Store(out).look()  # batches whose end is damaged do not say what they held: then all that is not there is due
    for one in found.damaged:
        aside(out, one)
    store = Store(out)
    lines, _ = store.lines(points.ids)
    found.due = [run_id for run_id in points.ids if run_id not in lines and (run_id in held or unsaid)]
    supervisor = Engine(store, points, lines, options, reporter)
    supervisor.due = Due(points.ids, np.array([points.ids.find(run_id) for run_id in found.due], int))
    with signals(supervisor.signal):
        if found.due:
            run_engine(supervisor, options)
            found.ran = sum(run_id in lines for run_id in found.due)
        if not supervisor.stopped and not (run_alone and not store.dataset.exists()):
            collect_last(Gather(store, plan, lines, reporter.note), supervisor)
    found.stopped = supervisor.broken or supervisor.stopped or ("the same `mpm run` makes run.nc again" if run_lost else "")


def aside(out: Path, one: dict) -> None:
    """Move a damaged file out of the way."""
    one["aside"] = str(set_aside(out / one["file"]).relative_to(out))


def in_words(found: Found) -> str:
    """The same in words."""
    state = f"{len(found.damaged)} damaged" if found.damaged else "all as they were written"
    told = [f"{found.out}: {found.files} files, {found.bytes / 1e6:.3g} MB: {state}"]
    told += [f"  {one['file']}: {one['why']}" + (f"; now {one['aside']}" if one["aside"] else "") for one in found.damaged[:20]]
    if len(found.damaged) > 20:
        told.append(f"  and {len(found.damaged) - 20} more")
    if found.left:
        told.append(f"  {found.left} half-written files of killed processes removed")
    if found.due:
        told.append(f"  {found.ran} of {len(found.due)} points run again")
    if found.lost:
        told.append(f"  {found.lost} points are not of the folder's present experiment, and did not run again")
    if found.stopped:
        told.append(f"  {found.stopped}")
    return "\n".join(told)
