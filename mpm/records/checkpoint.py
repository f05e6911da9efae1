"""Checkpoints: what a run remembers (mpm.memory), in one sealed file beside the results, so that a killed run goes on where it was, bit for bit.

    body    the arrays' bytes, one after another
    line    run_id, source, versions and processor that made it, when, and the memory with {"#": [offset, dtype, shape]} in the place of each array

Saved every so many seconds of wall time, and when the run is told to stop; a run that ends before that writes nothing. The seal is checked before a
byte is looked at. What other source, other versions or another processor made is not gone on with: the bits would differ.
Snapshots that lie in the run's own file (records.frames) are not in the checkpoint again: it says how many there are.
A checkpoint that cannot be written costs the run nothing but the checkpoint, and is told.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.frames import Stream
from mpm.records.netcdf import DamagedFile, seal, set_aside, unseal, write_whole
from mpm.records.provenance import now, processor, source_hash, versions

EVERY = 60.0  # wall time between two checkpoints, unless told [s]
SHARE = 20.0  # a checkpoint may take a twentieth of the time
ALIGN = 64


def pack(memory: Any, line: dict) -> bytes:
    """The bytes of a checkpoint: the one copy that is made of the memory."""
    parts: list[Any] = []
    size = 0

    def plain(value: Any) -> Any:
        nonlocal size
        if isinstance(value, dict):
            return {name: plain(inner) for name, inner in value.items()}
        if isinstance(value, list | tuple):
            return [plain(inner) for inner in value]
        if not isinstance(value, np.ndarray | np.generic):
            return value
        array = np.asarray(value)
        if array.dtype.kind not in "biuf":
            raise TypeError(f"a memory of {array.dtype} arrays cannot be kept")
        place = {"#": [size, array.dtype.str, list(array.shape)]}
        parts.extend((np.ascontiguousarray(array).reshape(-1).view(np.uint8), bytes(-array.nbytes % ALIGN)))
        size += array.nbytes + -array.nbytes % ALIGN
        return place

    told = plain(memory)
    return seal(parts, line | {"memory": told})


def unpack(data: bytes, path: Path | str = "") -> tuple[Any, dict]:
    """The memory and the line of a checkpoint, checked; DamagedFile where it is not what was written."""
    body, line = unseal(data, path)

    def full(value: Any) -> Any:
        if isinstance(value, list):
            return [full(inner) for inner in value]
        if not isinstance(value, dict):
            return value
        if value.keys() != {"#"}:
            return {name: full(inner) for name, inner in value.items()}
        offset, dtype, shape = value["#"]
        array = np.frombuffer(body, np.dtype(dtype), int(np.prod(shape)), offset).reshape(shape)
        return array.copy() if shape else array[()]

    return full(line.pop("memory")), line


class Checkpoint:
    """The keeper of one run. `every` in seconds of wall time; `note(text)` hears of what went wrong."""

    def __init__(self, path: Path | str, run_id: str, every: float = EVERY, note: Callable[[str], None] | None = None):
        self.path, self.every, self.note = Path(path), every, note or (lambda text: None)
        self.line = {"run_id": run_id, "source": source_hash(), "versions": versions(), "processor": processor()}
        self.there = False  # whether a file may be there
        self.cost = 0.0
        self.frames = Stream(self.path.with_suffix(".frames"))
        self.found = self.read()
        self.last = time.monotonic()

    def read(self) -> Any:
        """The memory of the same run made by the same source, versions and processor; anything else is moved or told, and the run starts from its start."""
        try:
            data = self.path.read_bytes()
        except FileNotFoundError:
            return None
        self.there = True
        try:
            memory, line = unpack(data, self.path)
        except DamagedFile as error:
            set_aside(self.path)
            self.there = False
            self.note(f"{error}; set aside, the run starts from its start")
            return None
        other = [name for name, value in self.line.items() if line.get(name) != value]
        if other:
            self.note(f"{self.path}: from other {' and '.join(other)}; the run starts from its start")
            return None
        frames = memory.get("recorder", {}).get("frames") if isinstance(memory, dict) else None
        if frames and not self.frames.kept(frames):
            self.note(f"{self.frames.path}: it does not hold what the checkpoint says; the run starts from its start")
            return None
        self.note(f"{self.path}: the run goes on from what was saved at {line.get('saved', 'an unknown time')}")
        return memory

    def due(self, stop: bool) -> bool:
        """Whether to save now."""
        return stop or time.monotonic() - self.last > max(self.every, SHARE * self.cost)

    def save(self, memory: Any) -> None:
        """Put the memory on disk, in the place of the one before."""
        began = time.monotonic()
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self.path, pack(memory, self.line | {"saved": now()}))
            self.there = True
        except OSError as error:
            self.note(f"no checkpoint: {error.filename}: {error.strerror}")
        self.last = time.monotonic()
        self.cost = self.last - began

    def drop(self) -> None:
        """The run is over: forget. Frames that have become the point's are elsewhere by now."""
        self.path.with_suffix(".frames").unlink(missing_ok=True)
        if self.there:
            self.path.unlink(missing_ok=True)
            self.there = False
