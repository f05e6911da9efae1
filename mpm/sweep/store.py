"""Store: the folder of a sweep. Points lie under their content id, so any sweep over the same folder finds what it shares with earlier ones.

    OUT/experiment.json      what the folder holds: config, key of the base, swept paths
    OUT/points/ab/<id>.nc    one sealed file a finished point, ok or not (records.point); `.damaged` where the seal did not hold
    OUT/batches/0000/<number>-<pass>.nc   one sealed file for the points of a batch (records.batch), FOLDER numbers a folder
    OUT/points/ab/<id>.frames   the point's snapshots, where they are large (records.frames)
    OUT/checkpoints/<id>.checkpoint   how far a point is that was stopped or killed (records.checkpoint); gone when it is done
    OUT/sweep.nc             the dataset (collect.py)
    OUT/lock                 held by the process that writes (lock.py)
A point of its own beats one in a batch, and a later batch an earlier one, so no clock decides which record holds.
"""

import contextlib
import errno
import itertools
import json
import os
import secrets
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import Any

from mpm.records.netcdf import DamagedFile, set_aside, summary, sync_folder, write_whole
from mpm.records.provenance import versions
from mpm.records.variables import TIMEOUT
from mpm.sweep.lock import Refused
from mpm.sweep.manifest import read_manifest, write_manifest
from mpm.sweep.summaries import Summaries

BATCH = "batch-"
FOLDER = 1000  # batches a folder
FEW = 100  # points that are looked for one by one rather than by listing folders


class Store:
    """Files of one sweep."""

    def __init__(self, out: Path | str):
        self.out = Path(out)
        self.seen: set[str] = set()  # batches whose summaries are known
        self.batched: dict[str, str] = {}  # run id -> the last batch that holds it

    @property
    def dataset(self) -> Path:
        """The assembled dataset."""
        return self.out / "sweep.nc"

    def path(self, name: str) -> Path:
        """Where a point's own file (its run id) or a batch's (`batch-<number>-<pass>`) lies; `places` says which of them holds a point."""
        if name.startswith(BATCH):
            stem = name.removeprefix(BATCH)
            return self.out / "batches" / f"{int(stem.partition('-')[0]) // FOLDER:04d}" / f"{stem}.nc"
        return self.out / "points" / name[:2] / f"{name}.nc"

    def checkpoint(self, run_id: str) -> Path:
        """Where a point that is not done keeps how far it is."""
        return self.out / "checkpoints" / f"{run_id}.checkpoint"

    def forget(self, run_ids: Iterable[str]) -> None:
        """Drop checkpoints, so that these points run from their start."""
        for path in {path for path in (self.out / "checkpoints").glob("*.*") if path.stem in set(run_ids)}:
            path.unlink(missing_ok=True)

    def tidy(self) -> int:
        """Remove what processes that were killed left half written (never at a final path); how many files."""
        left = [Path(folder, name) for folder, _, names in os.walk(self.out) for name in names if name.startswith(".") and name.endswith(".tmp")]
        for path in left:
            path.unlink(missing_ok=True)
        return len(left)

    def own(self, run_ids: Collection[str]) -> set[str]:
        """Those of the points that have a file of their own."""
        if len(run_ids) < FEW:
            return {run_id for run_id in run_ids if self.path(run_id).exists()}
        there: set[str] = set()
        for shard in {run_id[:2] for run_id in run_ids}:
            with contextlib.suppress(FileNotFoundError):
                there.update(name.removesuffix(".nc") for name in os.listdir(self.out / "points" / shard) if name.endswith(".nc"))
        return {run_id for run_id in run_ids if run_id in there} if there else there

    def places(self, run_ids: list[str]) -> dict[str, str]:
        """The name of what holds each point that is there: its own (the run id), or a batch's."""
        self.look()
        own = self.own(run_ids)
        return {run_id: run_id if run_id in own else self.batched[run_id] for run_id in run_ids if run_id in own or run_id in self.batched}

    def save(self, record: Any) -> None:
        """Put a point on disk, durably; when this returns the point counts."""
        from mpm.records.point import pack

        frames = self.path(record.run_id).with_suffix(".frames")
        if record.frames is not None:
            record.frames.settle(frames, copy=record.status == TIMEOUT)  # it may go on from its checkpoint
        elif frames.exists():
            frames.unlink()
        self.put(self.path(record.run_id), pack(record))

    def save_batch(self, records: list[Any], name: str) -> None:
        """Put small points on disk at once; those with fields get files of their own. None may have its own already: that one would go on to count."""
        from mpm.records.batch import fits, pack_batch

        together = [record for record in records if fits(record)] if len(records) > 1 else []
        if together:
            self.put(self.path(name), pack_batch(together))
        kept = {record.run_id for record in together}
        for record in (record for record in records if record.run_id not in kept):
            self.save(record)

    def put(self, path: Path, data: bytes) -> None:
        """A file, whole and durable, in a folder that may be new."""
        if not path.parent.is_dir():
            above = [folder for folder in (path.parent, path.parent.parent) if not folder.is_dir()]
            path.parent.mkdir(parents=True, exist_ok=True)
            for folder in above:
                sync_folder(folder.parent)
        write_whole(path, data)

    def load(self, run_id: str, fields: bool = True) -> Any:
        """A point, checked against its seal."""
        for _, record in self.load_all([run_id], fields, strict=True):
            return record
        raise FileNotFoundError(errno.ENOENT, "no such point", str(self.path(run_id)))

    def load_all(self, run_ids: list[str], fields: bool = True, strict: bool = False) -> Iterator[tuple[str, Any]]:
        """(run id, record) of each point that is there, by file, each file read once; DamagedFile in the place of a record unless `strict`."""
        from mpm.records.batch import read_batch
        from mpm.records.point import read

        by_file: dict[str, list[str]] = {}
        for run_id, name in self.places(run_ids).items():
            by_file.setdefault(name, []).append(run_id)
        for name, members in by_file.items():
            try:
                if name.startswith(BATCH):
                    found: dict[str, Any] = {record.run_id: record for record in read_batch(self.path(name))}
                else:
                    found = {name: read(self.path(name), fields)}
            except DamagedFile as error:
                if strict:
                    raise
                found = dict.fromkeys(members, error)
            for run_id in members:
                yield run_id, found[run_id]

    def batches(self) -> Iterator[tuple[str, Path]]:
        """Names and files of the batches, the later ones last."""
        return ((f"{BATCH}{path.stem}", path) for path in sorted((self.out / "batches").glob("*/[0-9]*.nc")))

    def look(self) -> list[str]:
        """Read the summaries of batches that have appeared since the last look; names of those whose end is damaged."""
        damaged = []
        for name, path in self.batches():
            if name in self.seen:
                continue
            try:
                line = summary(path)
            except DamagedFile:
                damaged.append(name)
                continue
            if line is not None:
                self.seen.add(name)
                for point in line["points"]:
                    if name >= self.batched.get(point["run_id"], ""):
                        self.batched[point["run_id"]] = name
        return damaged

    def bytes(self, run_ids: Iterable[str]) -> int:
        """Size of all files that hold these points."""
        files = [self.path(name) for name in set(self.places(list(run_ids)).values())]
        return sum(file.stat().st_size for path in files for file in (path, path.with_suffix(".frames")) if file == path or file.exists())

    def batch_names(self) -> Iterator[str]:
        """Names for the batches of one pass, after all that are there. A worker that outlives its engine may still write one: its name is no one else's."""
        used = (int(path.name.partition("-")[0]) for path in (self.out / "batches").glob("*/[0-9]*-*"))
        this = secrets.token_hex(4)
        return (f"{BATCH}{number:08d}-{this}" for number in itertools.count(max(used, default=-1) + 1))

    def lines(self, run_ids: Iterable[str]) -> tuple[Summaries, list[str]]:
        """Summaries of the points that are there, and the names (of points and batches) of files whose end is damaged."""
        found, damaged = Summaries(run_ids), []
        own = self.own(found.ids)
        for name, path in self.batches():
            try:
                line = summary(path)
            except DamagedFile:
                damaged.append(name)
                continue
            if line is not None:
                found.put_all(line["points"], without=own)
        for run_id in found.ids if own else ():
            if run_id in own:
                try:
                    line = point_line(self.path(run_id))
                except DamagedFile:
                    damaged.append(run_id)
                    continue
                if line is not None:
                    found[run_id] = line
        return found, damaged

    def news(self, run_ids: list[str], batch: str) -> list[dict]:
        """Summaries of a task's points, those that are whole, wherever its worker may have put them."""
        found: dict[str, dict | None] = {}
        with contextlib.suppress(DamagedFile):
            for line in (summary(self.path(batch)) or {"points": []})["points"] if batch else ():
                found[line["run_id"]] = line
        for run_id in self.own(run_ids):
            with contextlib.suppress(DamagedFile):
                found[run_id] = point_line(self.path(run_id)) or found.get(run_id)
        return [line for run_id in run_ids if (line := found.get(run_id))]

    def set_aside(self, name: str) -> Path:
        """Move a damaged file (of a point, or of a batch) out of the way, so that its points run again; nothing is deleted."""
        self.seen, self.batched = set(), {}  # an earlier batch may hold some of its points
        return set_aside(self.path(name))

    def experiment(self) -> dict | None:
        """What experiment.json says; None for a new folder."""
        return read_manifest(self.out / "experiment.json")

    def claim(self, experiment: Any, swept: list[str], smoke: bool, take_over: bool, kind: str = "sweep", join: bool = False) -> None:
        """Say in experiment.json what the folder holds. Refused where it holds another experiment, unless `take_over`.

        Other values on the axes, or another set of axes, are the same experiment: points are shared by id. A folder that held a
        `--smoke` run is taken over by the full one. With `join`, what it says stays where it is of the same experiment and varies as much.
        """
        new = {
            "format": 2,
            "name": experiment.name,
            "title": experiment.title,
            "smoke": smoke,
            "swept": swept,
            "key": experiment.key(),
            "resolved": experiment.resolved(),
            "source": experiment.source,
            "versions": versions(),
        } | ({"plan": kind} if kind != "sweep" else {})
        old = self.experiment()
        if old is not None:
            changed = differences(old["key"], new["key"], {*old["swept"], *swept})
            changed += [f"plan: {old.get('plan', 'sweep')} -> {kind}"] if old.get("plan", "sweep") != kind else []
            if changed and not take_over and not (old["smoke"] and not smoke):
                listed = "\n".join(f"  {line}" for line in changed[:12]) + (f"\n  and {len(changed) - 12} more" if len(changed) > 12 else "")
                raise Refused(
                    f"{self.out} holds another experiment ({old['name']}{', --smoke' if old['smoke'] else ''}):\n{listed}\n"
                    "choose another folder with --out, or let this experiment have it with --rerun stale (runs what the change affects) or --rerun all; "
                    "finished points stay on disk either way"
                )
            if join and not changed and {*old["swept"]} >= {*swept}:
                return
            if {name: old.get(name) for name in new if name != "versions"} == {name: new[name] for name in new if name != "versions"}:
                return
        write_manifest(self.out / "experiment.json", new)


def point_line(path: Path) -> dict | None:
    """The summary of a point's own file; None where there is no file. DamagedFile also where it is another point's."""
    line = summary(path)
    if line is not None:
        belongs(path, line.get("run_id"))
    return line


def belongs(path: Path, run_id: Any) -> None:
    """DamagedFile where a point's own file holds another point, as after a copy under a wrong name."""
    if run_id != path.stem:
        raise DamagedFile(f"{path}: it holds the point {run_id}")


def entries(value: Any) -> dict[str, Any] | None:
    """Mappings as they are, lists of mappings by their `name` where they have one (as sweeps call them) or their index; None for any other value."""
    if isinstance(value, dict):
        return value
    if isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
        return {str(item.get("name") or index): item for index, item in enumerate(value)}
    return None


def differences(old: Any, new: Any, without: set[str], path: str = "") -> list[str]:
    """`path: old -> new` where two trees differ, less the paths in `without`, what lies under them and what they lie in."""
    if old == new or any(path == w or path.startswith(w + ".") for w in without):
        return []
    one, two = entries(old), entries(new)
    if one is not None and two is not None:
        told = [differences(one.get(key, ABSENT), two.get(key, ABSENT), without, f"{path}.{key}" if path else key) for key in sorted({*one, *two})]
        return [line for part in told for line in part]
    if any(w.startswith(path + ".") for w in without):
        return []
    return [f"{path}: {short(old)} -> {short(new)}"]


ABSENT = object()


def short(value: Any) -> str:
    """A value in a message."""
    if value is ABSENT:
        return "absent"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 80 else text[:77] + "..."
