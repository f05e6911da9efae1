"""Store: the folder of a sweep. Points lie under their content id, so any sweep over the same folder finds what it shares with earlier ones.

    OUT/experiment.json      what the folder holds: config, key of the base, swept paths
    OUT/points/ab/<id>.nc    one sealed file a finished point, ok or not (records.point); `.damaged` where the seal did not hold
    OUT/sweep.nc             the dataset (collect.py)
    OUT/lock                 held with flock by the process that writes: the kernel releases it when its owner dies
"""

import fcntl
import json
import os
import platform
from pathlib import Path
from typing import Any

from mpm.records.netcdf import DamagedFile, summary, sync_folder, write_whole
from mpm.records.provenance import now, versions


class Refused(Exception):
    """The folder cannot be used as asked; the text says why and what can be done."""


class Store:
    """Files of one sweep."""

    def __init__(self, out: Path | str):
        self.out = Path(out)

    @property
    def dataset(self) -> Path:
        """The assembled dataset."""
        return self.out / "sweep.nc"

    def path(self, run_id: str) -> Path:
        """Where a point lies."""
        return self.out / "points" / run_id[:2] / f"{run_id}.nc"

    def save(self, record: Any) -> None:
        """Put a point on disk, durably; when this returns the point counts."""
        from mpm.records.point import pack

        path = self.path(record.run_id)
        if not path.parent.is_dir():
            path.parent.mkdir(parents=True, exist_ok=True)
            sync_folder(path.parent.parent)
        write_whole(path, pack(record))

    def load(self, run_id: str, fields: bool = True) -> Any:
        """A point, checked against its seal."""
        from mpm.records.point import read

        return read(self.path(run_id), fields)

    def lines(self, run_ids: list[str]) -> tuple[dict[str, dict], list[str]]:
        """Summaries of the points that are there, and the ids of files whose end is damaged."""
        found, damaged = {}, []
        for run_id in run_ids:
            try:
                line = summary(self.path(run_id))
            except DamagedFile:
                damaged.append(run_id)
                continue
            if line is not None:
                found[run_id] = line
        return found, damaged

    def set_aside(self, run_id: str) -> Path:
        """Move a damaged file out of the way, so that the point runs again; nothing is deleted."""
        path = self.path(run_id)
        return path.rename(path.with_suffix(".damaged"))

    def experiment(self) -> dict | None:
        """What experiment.json says; None for a new folder."""
        try:
            return json.loads((self.out / "experiment.json").read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except ValueError as error:
            raise Refused(f"{self.out / 'experiment.json'} is damaged ({error}); move it away, the points beside it are kept and found again") from None

    def claim(self, experiment: Any, swept: list[str], smoke: bool, take_over: bool, kind: str = "sweep") -> None:
        """Say in experiment.json what the folder holds. Refused where it holds another experiment, unless `take_over`.

        Other values on the axes, or another set of axes, are the same experiment: points are shared by id. A folder that held a
        `--smoke` run is taken over by the full one.
        """
        new = {
            "format": 1,
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
            if {name: old.get(name) for name in new if name != "versions"} == {name: new[name] for name in new if name != "versions"}:
                return
        write_whole(self.out / "experiment.json", json.dumps(new, indent=1, ensure_ascii=False).encode())


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


class Lock:
    """`with Lock(folder):` one writer a folder. A dead owner cannot hold it."""

    def __init__(self, folder: Path):
        self.path = Path(folder) / "lock"
        self.descriptor = -1

    def __enter__(self) -> "Lock":
        descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            raise Refused(f"{self.path.parent} is in use by {said_owner(owner(self.path.parent))}; wait for it, or choose another folder with --out") from None
        self.descriptor = descriptor
        os.ftruncate(descriptor, 0)
        os.write(descriptor, json.dumps({"pid": os.getpid(), "host": platform.node(), "since": now()}).encode())
        return self

    def __exit__(self, *_: object) -> None:
        os.ftruncate(self.descriptor, 0)
        os.close(self.descriptor)


def owner(folder: Path) -> dict | None:
    """Who sweeps in a folder now: {pid, host, since}; None for nobody."""
    try:
        descriptor = os.open(Path(folder) / "lock", os.O_RDWR)
    except FileNotFoundError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return None
    except BlockingIOError:
        text = os.pread(descriptor, 4096, 0)
        return json.loads(text) if text.endswith(b"}") else {}
    finally:
        os.close(descriptor)


def said_owner(found: dict | None) -> str:
    """The owner in words."""
    return f"process {found['pid']} on {found['host']} since {found['since']}" if found else "another process"
