"""Groups of labelled arrays to the bytes of a NetCDF-4 file; bytes to disk, whole or not at all; and a seal that shows damage.

A file is serialised in memory, then written beside its target, synced, renamed over it, and the folder synced: whoever opens the target
finds the old file or the new one, never half. A full disk is then a plain OSError (h5py writing in place crashes the process).

A sealed file ends in one line of JSON, the SHA-256 of everything before it, and the line's own CRC-32. HDF5 does not look past its own end, so every
reader of NetCDF-4 opens it; `summary` reads and checks the line alone, without HDF5, in some 20 microseconds.
"""

import hashlib
import io
import itertools
import json
import math
import os
import secrets
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from mpm.text import storable

PACKED = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
CHUNK = 2**20  # bytes that a chunk holds at least, where there are as many
WHOLE = {"x", "y", "z", "r", "direction", "time"}  # dimensions that are never cut: a chunk holds whole frames and whole series
DIGEST = 64
TAIL = DIGEST + 18  # newline, digest, newline, CRC-32 and length of the line as 8 hex digits each


class DamagedFile(Exception):
    """A sealed file whose end is missing or whose contents do not match its seal."""


@dataclass(frozen=True)
class Array:
    """A variable: dimensions, values, attributes."""

    dims: tuple[str, ...]
    data: Any
    attrs: dict[str, Any] = field(default_factory=dict)


@dataclass
class Group:
    """Variables by name."""

    variables: dict[str, Array] = field(default_factory=dict)

    def sizes(self) -> dict[str, int]:
        """Length of every dimension; ValueError where two variables disagree."""
        sizes: dict[str, int] = {}
        for name, variable in self.variables.items():
            shape = np.shape(variable.data)
            if len(shape) != len(variable.dims):
                raise ValueError(f"{name}: dimensions {variable.dims} for an array of shape {shape}")
            for dim, size in zip(variable.dims, shape, strict=True):
                if sizes.setdefault(dim, size) != size:
                    raise ValueError(f"{name}: dimension {dim} has length {size}, elsewhere {sizes[dim]}")
        return sizes


def attribute(value: Any) -> Any:
    """What NetCDF can hold as an attribute: a string without NUL, a number, an array of numbers; anything else as JSON."""
    if isinstance(value, str):
        return storable(value)
    if isinstance(value, np.ndarray | np.generic) or (isinstance(value, int | float) and not isinstance(value, bool)):
        return value
    return storable(json.dumps(value, ensure_ascii=False))


def to_bytes(groups: dict[str, Group], attrs: dict[str, Any]) -> bytes:
    """A NetCDF-4 file; `groups` by path, "/" first. Each has dimensions of its own, so that it can be opened alone."""
    buffer = io.BytesIO()
    write_groups(buffer, groups, attrs)
    return buffer.getvalue()


def write_groups(target: Any, groups: dict[str, Group], attrs: dict[str, Any]) -> None:
    """The same into an open file."""
    import h5netcdf

    with h5netcdf.File(target, "w") as file:
        for name, value in attrs.items():
            file.attrs[name] = attribute(value)
        for path, group in groups.items():
            target, lengths = file if path == "/" else file.create_group(path), chunks(group)
            target.dimensions = group.sizes()
            for name, variable in group.variables.items():
                put(target, name, variable, lengths)


def chunks(group: Group) -> dict[str, int]:
    """Length of a chunk along each dimension, one for all variables of a group, as tools that read a part at a time want it.

    A chunk of a variable holds CHUNK bytes or more, where there are as many. What has only some of the dimensions of another variable follows it.
    """
    sizes = group.sizes()
    lengths = {dim: size if dim in WHOLE else 1 for dim, size in sizes.items()}
    every = {variable.dims for variable in group.variables.values()}
    for variable in group.variables.values():
        if any(set(variable.dims) < set(dims) for dims in every):
            continue
        data = variable.data if hasattr(variable.data, "itemsize") else np.asarray(variable.data)
        size = data.itemsize * math.prod(sizes[dim] for dim in variable.dims if dim in WHOLE)
        for dim in [dim for dim in reversed(variable.dims) if dim not in WHOLE]:
            lengths[dim] = max(lengths[dim], cut(sizes[dim], math.ceil(CHUNK / max(1, size))))
            size *= lengths[dim]
    return lengths


def cut(size: int, least: int) -> int:
    """Length of the parts of a dimension: `least` or a little more, also of the last part."""
    parts = (math.ceil(size / number) for number in range(size // least, 0, -1))
    return next((length for length in parts if (size - 1) % length + 1 >= least), size)


def put(group: Any, name: str, variable: Array, lengths: dict[str, int]) -> None:
    """Write one variable in chunks of these lengths; numbers compressed and checksummed, text and single numbers as they are."""
    data = variable.data if hasattr(variable.data, "make") else np.asarray(variable.data)
    how: dict[str, Any] = {"chunks": tuple(lengths[dim] for dim in variable.dims)} if data.size and data.ndim else {}
    if not isinstance(data, np.ndarray):  # records.large.Parts
        target = group.create_variable(name, variable.dims, dtype=data.dtype, **(how | PACKED | {"compression_opts": 1} if how else {}))
        data.fill(target)
    elif data.dtype.kind in "OU":
        import h5py

        text = np.array([storable(str(value)) for value in data.ravel()], dtype=object).reshape(data.shape)
        target = group.create_variable(name, variable.dims, dtype=h5py.string_dtype(), data=text, **how)
    else:
        target = group.create_variable(name, variable.dims, data=data, **(how | PACKED if how else {}))
    for key, value in variable.attrs.items():
        target.attrs[key] = attribute(value)


def seal(body: bytes | list, line: dict) -> bytes:
    """`body` (or its parts, which are copied once), one line of JSON, and the digest of both."""
    text = json.dumps(line, ensure_ascii=False).encode(errors="backslashreplace")  # halves of pairs, which JSON writes so too
    parts = body if isinstance(body, list) else [body]
    return b"".join([*parts, text, closing(text, *parts, text)])


def closing(text: bytes, *parts: bytes | memoryview, digest: Any = None) -> bytes:
    """The last TAIL bytes of a sealed file whose line is `text`, and whose `parts` one after another are all before them, after what `digest` has seen."""
    digest = digest or hashlib.sha256()
    for part in parts:
        digest.update(part)
    return f"\n{digest.hexdigest()}\n{zlib.crc32(text):08x}{len(text):08x}".encode()


def unseal(data: bytes, path: Path | str = "") -> tuple[bytes, dict]:
    """The body and the line of a sealed file, checked."""
    try:
        length = int(data[-8:], 16)
        text = data[-TAIL - length : -TAIL]
        if len(text) == length and data[-TAIL:] == closing(text, memoryview(data)[:-TAIL]):
            return data[: -TAIL - length], json.loads(text)
    except ValueError:
        pass  # told below, with the same words as any other damage
    raise DamagedFile(f"{path}: damaged, its contents do not match its checksum")


def summary(path: Path | str) -> dict | None:
    """The line of a sealed file, checked, without reading the rest; None where there is no file. The body stays unchecked."""
    try:
        with open(path, "rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - 4096))
            end = file.read()
            length = int(end[-8:], 16)
            if length + TAIL > len(end):
                file.seek(max(0, size - TAIL - length))
                end = file.read()
            text = end[-TAIL - length : -TAIL]
            if end[-17:] != f"\n{zlib.crc32(text):08x}{len(text):08x}".encode():
                raise ValueError("checksum")
            return json.loads(text)
    except FileNotFoundError:
        return None
    except ValueError:
        raise DamagedFile(f"{path}: damaged, its end is missing or is not what was written") from None


def write_whole(path: Path | str, data: bytes) -> None:
    """Put `data` at `path` so that a reader, or a crash at any moment, sees the old file or the new one. OSError names path and size."""
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
        try:
            view = memoryview(data)
            while view:
                view = view[os.write(descriptor, view) :]
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
        os.replace(temporary, path)
        sync_folder(path.parent)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise OSError(error.errno, f"cannot write {len(data)} bytes: {error.strerror}{free_space(path.parent)}", str(path)) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def sync_folder(folder: Path) -> None:
    """Make the names in a folder durable. OSError names it."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        raise OSError(error.errno, f"cannot make its entries durable: {error.strerror}", str(folder)) from error
    finally:
        os.close(descriptor)


def set_aside(path: Path) -> Path:
    """Rename a damaged file to `<name>.damaged` (or `.damaged2`, ...): out of the way, and nothing is deleted."""
    places = (path.with_suffix(f".damaged{number if number > 1 else ''}") for number in itertools.count(1))
    place = next(place for place in places if not place.exists())
    return path.rename(place)


def free_space(folder: Path) -> str:
    """` (N bytes free)`, or nothing where the folder cannot be asked."""
    try:
        room = os.statvfs(folder)
    except OSError:
        return ""
    return f" ({room.f_bavail * room.f_frsize} bytes free)"
