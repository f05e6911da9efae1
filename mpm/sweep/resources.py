"""Memory and disk that points may take. Asked before a point starts; `processes` watches the memory of those that run.

Memory   a point that needs more than the limit is refused, with its estimate (mpm.costs.memory, within 20 %); one that would not fit beside those
         that run waits for them. The limit is what --memory says, else what is free in the machine or in the control group when the sweep starts.
Disk     no point starts unless there is room for it, for those that run and for the dataset; the sweep stops when nothing runs and there is none.
"""

import math
import os
import time
from pathlib import Path
from typing import Any

ADVICE = "a coarser grid.cell, fewer particles a cell or fewer snapshots need less; with more memory allowed (--memory), --rerun failed tries again"
SPARE = 256 * 1024  # bytes of disk for what is small: experiment.json, the lock, folders


class Resources:
    """What is free, and what running tasks have been given of it."""

    def __init__(self, out: Path, memory: float | None, far: bool):
        """`far`: points run on other machines, whose memory is not ours to count."""
        self.out = out
        self.free = float("inf") if far else available()
        self.limit = min(memory or self.free, self.free)
        self.said = "allowed (--memory)" if memory and memory <= self.free else "free"
        self.given: dict[str, int] = {}

    def need(self, experiment: Any) -> int:
        """Bytes of memory of a process that runs the point; a bound where that is small."""
        from mpm.costs import memory, memory_at_most
        from mpm.scene.refusal import SceneError

        bound = memory_at_most(experiment)
        if bound <= min(self.limit, self.free - sum(self.given.values())):
            return bound
        try:
            return memory(experiment)
        except SceneError:  # it cannot run at all, and says why when it tries
            return 0

    def refusal(self, need: int) -> str:
        """Why a point of this need cannot run here; empty where it can."""
        return f"needs about {size(need)} of memory, and {size(self.limit)} are {self.said}" if need > self.limit else ""

    def fits(self, need: int) -> bool:
        """Whether there is memory for it beside what runs."""
        return not self.given or sum(self.given.values()) + need <= self.free

    def short(self, run: int, experiment: Any) -> str:
        """Why so many more points, with those that run, do not fit on the disk; empty where they do."""
        dataset = self.out / "sweep.nc"
        wanted = SPARE + run * output(experiment) + (dataset.stat().st_size if dataset.exists() else 0)
        free = free_disk(self.out)
        return f"{self.out}: {wanted} bytes are needed to go on, {free} bytes are free" if free < wanted else ""

    def warning(self, due: int, experiment: Any) -> str:
        """What to say at the start, where all points together may not fit on the disk."""
        wanted, free = due * output(experiment), free_disk(self.out)
        if wanted <= free:
            return ""
        return f"{self.out}: the points may need up to {size(wanted)}, {size(free)} are free; the sweep stops when that is used up, and goes on where it was"


def output(experiment: Any) -> int:
    """Bytes of the point's file, at most about."""
    from mpm.costs import count_particles
    from mpm.scene.inventory import output_bytes

    snapshots = experiment.output.snapshots
    return output_bytes(experiment, count_particles(experiment) if snapshots is not None and snapshots.particles else 0)


def free_disk(folder: Path) -> int:
    """Bytes that may still be written in a folder."""
    room = os.statvfs(folder)
    return room.f_bavail * room.f_frsize


def available() -> float:
    """Bytes of memory that are free: in the machine, or in this process's control group where that allows less."""
    found = [float("inf")]
    try:
        rows = dict(line.split(":", 1) for line in Path("/proc/meminfo").read_text().splitlines())
        found.append(float(rows["MemAvailable"].split()[0]) * 1024)
        group = next((line.split("::", 1)[1] for line in Path("/proc/self/cgroup").read_text().splitlines() if line.startswith("0::")), "/")
        for folder in {Path("/sys/fs/cgroup"), Path("/sys/fs/cgroup") / group.lstrip("/")}:
            if (most := read(folder / "memory.max")) is not None:
                found.append(most - (read(folder / "memory.current") or 0.0))
    except (OSError, KeyError, ValueError, IndexError):
        pass  # another system: nothing is known, and nothing is limited unless told
    return min(found)


def read(path: Path) -> float | None:
    """A number in a file of the kernel's; None for `max`, or for no file."""
    try:
        return float(path.read_text())
    except (OSError, ValueError):
        return None


def resident(pid: int) -> int:
    """Bytes of memory that a process has; 0 for one that is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError):
        return 0


class Pulse:
    """Whether a process does anything, by the processor time that it uses; where the system does not tell, it is taken to."""

    def __init__(self, pid: int):
        self.pid, self.used, self.moved = pid, 0.0, time.monotonic()

    def beat(self) -> None:
        """It may rest now."""
        self.moved = time.monotonic()

    def still(self, seconds: float) -> bool:
        """Whether it has used no time for so long. Ask often."""
        try:
            fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
            used = float(fields[11]) + float(fields[12])
        except (OSError, ValueError, IndexError):
            used = math.nan
        if used != self.used:
            self.used = used
            self.beat()
        return time.monotonic() - self.moved > seconds


def size(count: float) -> str:
    """Bytes for people."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} TB"
