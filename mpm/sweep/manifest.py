"""experiment.json: what a sweep's folder holds, as plain JSON whose last entry is the SHA-256 of all before it."""

import errno
import hashlib
import json
from pathlib import Path
from typing import Any

from mpm.records.netcdf import write_whole
from mpm.records.provenance import versions
from mpm.sweep.lock import Refused

MARK = b',\n "sha256": "'


def write_manifest(path: Path, about: dict[str, Any]) -> None:
    """Write it, whole."""
    head = json.dumps(about, indent=1, ensure_ascii=False).encode(errors="backslashreplace").removesuffix(b"\n}")
    write_whole(path, head + closing(head))


def closing(head: bytes) -> bytes:
    """The end of the file."""
    return MARK + hashlib.sha256(head).hexdigest().encode() + b'"\n}'


def claimed(out: Path) -> dict:
    """What it says of a folder that a sweep is using; FileNotFoundError where somebody has taken it away since."""
    if (found := read_manifest(out / "experiment.json")) is None:
        raise FileNotFoundError(errno.ENOENT, "it is not there any more", str(out / "experiment.json"))
    return found


def read_manifest(path: Path) -> dict | None:
    """What it says; None where there is none. Refused where a byte is not as it was written (format 1 had no checksum)."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    try:
        found = json.loads(data)
    except ValueError as error:
        raise damaged(path, str(error)) from None
    head, mark, _ = data.rpartition(MARK)
    if not isinstance(found, dict) or (found.get("format") != 1 and data != head + closing(head)) or (found.get("format") == 1 and mark):
        raise damaged(path, "it does not match its checksum")
    return {name: value for name, value in found.items() if name != "sha256"}


def damaged(path: Path, why: str) -> Refused:
    """The refusal."""
    return Refused(f"{path} is damaged ({why}); move it away, the points beside it are kept and found again")


def about_one(experiment: Any, case: Any, record: Any, smoke: bool = False) -> dict[str, Any]:
    """What experiment.json would say of the point alone."""
    return {
        "title": experiment.title,
        "name": experiment.name,
        "source": experiment.source,
        "smoke": smoke,
        "swept": [],
        "resolved": case.experiment.resolved(),
        "versions": versions(),
        "threads": record.facts.get("threads", 1),
    }
