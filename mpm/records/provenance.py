"""Where a result comes from: source, versions, machine. Only an allow-list of facts; nothing of the environment.

`source_hash` covers every room that can change a number: all but those that keep, show or run over what was computed.
"""

import functools
import importlib.metadata
import os
import platform
import subprocess
from datetime import UTC, datetime
from pathlib import Path

from mpm import fingerprint

ROOT = Path(__file__).resolve().parents[1]
CANNOT_CHANGE_A_NUMBER = {"records", "sweep", "study", "benchmarks", "plots", "opened", "exports", "movies", "reports"}
PACKAGES = ("mpm", "numpy", "numba", "llvmlite", "scipy", "h5py", "h5netcdf", "xarray")


@functools.cache
def source_hash() -> str:
    """Hash of the source that made a result (16 hex digits). Read file by file: all texts at once would be a twentieth of a sweep's process."""
    places = ((path, path.relative_to(fingerprint.PACKAGE)) for path in sorted(fingerprint.PACKAGE.rglob("*.py")))
    kept = ((path, place) for path, place in places if place.parts[0].removesuffix(".py") not in CANNOT_CHANGE_A_NUMBER)
    return fingerprint.digest({place.as_posix(): path.read_text(encoding="utf-8")} for path, place in kept)


@functools.cache
def versions() -> dict[str, str]:
    """Versions of what computes and writes."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


@functools.cache
def git_revision() -> str:
    """Revision of the source tree, `+changes` where it differs; empty outside a repository."""
    if not (ROOT.parent / ".git").exists():
        return ""
    try:
        command = ["git", "-C", str(ROOT.parent), "describe", "--always", "--abbrev=12", "--dirty=+changes"]
        return subprocess.run(command, capture_output=True, text=True, timeout=5, check=False).stdout.strip()
    except (OSError, subprocess.TimeoutExpired):
        return ""


@functools.cache
def machine() -> dict:
    """The machine, as far as it explains a wall time."""
    return {"system": platform.system(), "processor": processor(), "cores": cores()}


def processor() -> str:
    """The processor's name."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        return platform.processor() or platform.machine()
    return platform.machine()


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def now() -> str:
    """The time, UTC, ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")
