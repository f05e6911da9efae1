"""Frames: the snapshots of one run in a file of their own, `<run id>.frames`, one after another as they are made.

entry    body: HDF5 with grid/<field> and particles/<field>;   line: {"time": seconds, "body": bytes of the body}, sealed (records.netcdf)

An entry is readable as soon as it is written, a torn last one is told by its seal, and frame k is read without any other: only the lines, at the ends of the
entries, are looked at on the way. Snapshots of less than SPILL bytes in all stay in memory, and go into the point's own file.
"""

import io
import json
import os
import shutil
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mpm.memory import Frames
from mpm.records.netcdf import TAIL, DamagedFile, free_space, seal, sync_folder, unseal

SPILL = 2**20  # bytes of arrays that a run keeps in memory
PACKED = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


class Unwritten(OSError):
    """Frames that the disk does not take: the run stops, and can go on from its checkpoint."""


class Frame(NamedTuple):
    """One snapshot: time [s], fields on the grid by name, fields of particles by name."""

    time: float
    grid: dict[str, np.ndarray]
    particles: dict[str, np.ndarray]


class Entries(Sequence):
    """Frames of a file, or of its first `size` bytes. Opening reads lines alone; `frames[k]` reads and checks entry k."""

    def __init__(self, path: Path | str, size: int | None = None):
        self.path = Path(path)
        self.ends: list[int] = []
        self.seconds: list[float] = []
        with open(self.path, "rb") as file:
            end = file.seek(0, os.SEEK_END) if size is None else size
            while end > 0:
                length, line = last_line(file, end, self.path)
                self.ends.append(end)
                self.seconds.append(line["time"])
                end -= TAIL + length + line["body"]
        if end < 0:
            raise DamagedFile(f"{self.path}: damaged, an entry begins before the file")
        self.ends.reverse()
        self.seconds.reverse()

    @property
    def times(self) -> np.ndarray:
        """When they were taken [s]."""
        return np.array(self.seconds)

    def __len__(self) -> int:
        return len(self.ends)

    def __getitem__(self, k: int) -> Frame:  # type: ignore[override]  # one at a time: no slices
        if not -len(self) <= k < len(self):
            raise IndexError(k)
        k %= len(self)
        begin = self.ends[k - 1] if k else 0
        with open(self.path, "rb") as file:
            file.seek(begin)
            data = file.read(self.ends[k] - begin)
        return unpacked(*unseal(data, self.path))

    def part(self, k: int, name: str) -> np.ndarray:
        """One field of the particles of entry k, which `frames[k]` has checked before."""
        import h5py

        begin = self.ends[k - 1] if k else 0
        with open(self.path, "rb") as file:
            file.seek(begin)
            data = file.read(self.ends[k] - begin)
        with h5py.File(io.BytesIO(data)) as body:
            return body["particles"][name][()]

    def opened(self) -> "Entries":
        """Itself: it is open."""
        return self


def last_line(file: Any, end: int, path: Path) -> tuple[int, dict]:
    """Length and contents of the line of the entry that ends at `end`."""
    reach = min(end, 512)
    file.seek(end - reach)
    data = file.read(reach)
    try:
        length = int(data[-8:], 16)
        text = data[-TAIL - length : -TAIL]
        if len(text) != length or data[-17:] != f"\n{zlib.crc32(text):08x}{length:08x}".encode():
            raise ValueError("checksum")
        return length, json.loads(text)
    except ValueError:
        raise DamagedFile(f"{path}: damaged, what ends at byte {end} is not what was written") from None


def packed(when: float, grid: dict, particles: dict) -> bytes:
    """The bytes of an entry."""
    import h5py

    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver="latest") as file:
        for group, fields in (("grid", grid), ("particles", particles)):
            for name, values in fields.items():
                values = np.asarray(values, np.float32 if group == "grid" else None)
                file.create_dataset(f"{group}/{name}", data=values, **(PACKED | {"chunks": values.shape} if values.size else {}))
    body = buffer.getvalue()
    return seal(body, {"time": when, "body": len(body)})


def unpacked(body: bytes, line: dict) -> Frame:
    """The frame of an entry."""
    import h5py

    with h5py.File(io.BytesIO(body)) as file:
        return Frame(line["time"], *({name: values[()] for name, values in file[group].items()} if group in file else {} for group in ("grid", "particles")))


class Stream(Frames, Sequence):
    """Frames that go to `path` once they are more than SPILL bytes."""

    def __init__(self, path: Path | str):
        super().__init__()
        self.path = Path(path)
        self.bytes = 0
        self.ends: list[int] = []
        self.seconds: list[float] = []

    @property
    def times(self) -> np.ndarray:
        """When they were taken [s]."""
        return np.array(self.seconds) if self.ends else super().times

    def __len__(self) -> int:
        return len(self.ends) or len(self.held)

    def __getitem__(self, k: int) -> Frame:  # type: ignore[override]  # one at a time: no slices
        return self.opened()[k] if self.ends else Frame(*self.held[k])

    def add(self, when: float, grid: dict, particles: dict) -> None:
        """Take a frame at a time [s]; beyond SPILL bytes all go to the file."""
        super().add(when, grid, particles)
        self.bytes += sum(np.asarray(values).nbytes for fields in (grid, particles) for values in fields.values())
        if self.bytes > SPILL:
            for frame in self.held:
                self.append(*frame)
            self.held.clear()

    def append(self, when: float, grid: dict, particles: dict) -> None:
        """One entry at the end of the file."""
        end, data = self.ends[-1] if self.ends else 0, packed(when, grid, particles)
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with open(self.path, "r+b" if end else "wb", buffering=0) as file:
                file.truncate(end)
                file.seek(end)
                view = memoryview(data)
                while view:
                    view = view[file.write(view) :]
        except OSError as error:
            raise Unwritten(error.errno, f"cannot write {len(data)} bytes: {error.strerror}{free_space(self.path.parent)}", str(self.path)) from error
        self.ends.append(end + len(data))
        self.seconds.append(when)

    def drop(self) -> None:
        """Forget the last."""
        if self.ends:
            self.ends.pop()
            self.seconds.pop()
        else:
            super().drop()

    def clear(self) -> None:
        """Forget all; the file is not touched."""
        super().clear()
        self.bytes, self.ends, self.seconds = 0, [], []

    def memory(self) -> Any:
        """What is in the file is not kept again, but is on disk before this returns."""
        self.sync()
        return {"held": super().memory(), "bytes": self.bytes, "ends": np.array(self.ends, int), "times": np.array(self.seconds)}

    def recall(self, found: Any) -> None:
        """Go on from what `memory` gave."""
        super().recall(found["held"])
        self.bytes, self.ends, self.seconds = int(found["bytes"]), found["ends"].tolist(), found["times"].tolist()

    def opened(self) -> Entries:
        """The file, as a reader has it."""
        return Entries(self.path, self.ends[-1])

    def settle(self, place: Path, copy: bool) -> None:
        """Move the file, durable, to where it stays; or copy it there, where the run may go on."""
        self.sync()
        place.parent.mkdir(parents=True, exist_ok=True)
        self.path = Path(shutil.copyfile(self.path, place)) if copy else self.path.replace(place)
        if copy:
            self.sync()
        sync_folder(place.parent)

    def sync(self) -> None:
        """Make durable what is in the file."""
        if self.ends:
            with open(self.path, "r+b", buffering=0) as file:
                file.truncate(self.ends[-1])
                os.fsync(file.fileno())

    def kept(self, found: Any) -> bool:
        """Whether the file has what a `memory` says."""
        ends = found["ends"].tolist()
        try:
            return not ends or Entries(self.path, ends[-1]).ends == ends
        except (OSError, DamagedFile):
            return False
