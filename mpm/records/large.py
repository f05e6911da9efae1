"""Datasets that are written piece by piece: what lies in files of frames goes into the dataset without ever being in memory as a whole.

The file is written beside its target by h5netcdf, sealed, synced and renamed over it. An error of the disk is kept until HDF5 has closed the file (which
would crash the process otherwise), and is then an OSError with path and size.
"""

import hashlib
import io
import json
import os
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.netcdf import Group, closing, free_space, sync_folder, write_groups


class Parts:
    """An array (N, ...) that is made part by part along its first dimension. `make()` yields the parts in order; their lengths sum up to N."""

    def __init__(self, shape: tuple[int, ...], dtype: Any, make: Callable[[], Iterator[np.ndarray]]):
        self.shape, self.dtype, self.make = shape, np.dtype(dtype), make
        self.itemsize, self.ndim, self.size = self.dtype.itemsize, len(shape), int(np.prod(shape))

    def fill(self, target: Any) -> None:
        """Put the parts into a variable of a file."""
        begin = 0
        for values in self.make():
            target[begin : begin + len(values)] = values
            begin += len(values)


class Careful(io.FileIO):
    """A file whose writes do not fail: the first error is kept in `error`."""

    error: OSError | None = None

    def write(self, data: Any) -> int:
        """All of it, however much the system takes at once; after the first error, which is kept, what comes is lost."""
        view = memoryview(data).cast("B")
        whole = len(view)
        try:
            while view and self.error is None:
                view = view[super().write(view) :]
        except OSError as error:
            self.error = error
        return whole


def write_sealed(path: Path | str, groups: dict[str, Group], attrs: dict[str, Any], line: dict) -> None:
    """A sealed NetCDF-4 file at `path`, whole or not at all."""
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.tmp")
    try:
        with Careful(temporary, "x+b") as file:
            fill(file, groups, attrs)
            digest = hashlib.sha256()
            file.seek(0)
            while data := file.read(2**20):
                digest.update(data)
            text = json.dumps(line, ensure_ascii=False).encode(errors="backslashreplace")
            file.write(text + closing(text, text, digest=digest))
            if file.error is not None:
                raise file.error
            os.fsync(file.fileno())
        os.replace(temporary, path)
        sync_folder(path.parent)
    except OSError as error:
        size = temporary.stat().st_size if temporary.exists() else 0
        temporary.unlink(missing_ok=True)
        raise OSError(error.errno, f"cannot write more than {size} bytes: {error.strerror}{free_space(path.parent)}", str(path)) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def fill(file: Careful, groups: dict[str, Group], attrs: dict[str, Any]) -> None:
    """The body. After an error of the disk HDF5 may find what it reads back wrong: the disk's error is what is told."""
    try:
        write_groups(file, groups, attrs)
    except Exception:
        if file.error is None:
            raise
