"""Measured curves: a CSV beside the config, read when the config is, so that a point carries its data and no path.

Columns are named with their units: `minute`, `second`, `hour`; temperatures end in `_degC` or `_K`. Lines that start with # are comments.
Rows may stand in any order of time; they are kept by rising time. Everything else that is not plain is refused with its line.
"""

import csv
import math
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from mpm.config.base import Model, doc
from mpm.config.explain import Finding
from mpm.config.problems import brief, listed

SECONDS = {"second": 1.0, "minute": 60.0, "hour": 3600.0}
KELVIN = {"_degC": 273.15, "_K": 0.0}
MOST_BYTES, MOST_ROWS = 64 * 2**20, 100_000  # of a file; of its curve, which every point carries


class Measured(Model):
    """A measured temperature at a probe."""

    file: str = doc(description="CSV file, relative to the config")
    time: str = doc("second", description="column of the time: second, minute or hour")
    value: str = doc(description="column of the temperature; its name ends in _degC or _K")
    samples: tuple[tuple[float, float], ...] = doc((), description="what the file holds: (second, kelvin); filled in when the config is read")


class Unreadable(ValueError):
    """What is wrong with a file, and what would be right. `column`: the key of the config that names it, where it is a column's name that is wrong."""

    def __init__(self, line: int, message: str, allowed="", column: str = "file"):
        super().__init__(f"line {line}: {message}" if line else message)
        self.line, self.message, self.allowed, self.column = line, message, allowed, column


def embed(experiment, folder: Path) -> Iterator[Finding]:
    """Fill in `samples` from the files, which are relative to `folder`; yields what is wrong with them."""
    for probe, curve in experiment.output.measured.items():
        place = ("output", "measured", probe)
        if probe not in experiment.output.probes:
            yield Finding(place, f"there is no probe {probe!r}", list(experiment.output.probes), on_key=True)
        elif not curve.samples:
            try:
                samples = tuple(read(folder / curve.file, curve.time, curve.value))
            except OSError as error:
                yield Finding((*place, "file"), f"cannot read {curve.file!r}: {error.strerror}", "a CSV file beside the config")
            except Unreadable as error:
                where = f"{curve.file}:{error.line}" if error.line else curve.file
                key = error.column if error.column == "file" or error.column in curve.model_fields_set else "file"
                yield Finding((*place, key), f"{where}: {error.message}", error.allowed)
            except ValueError as error:  # a name that no file can have
                yield Finding((*place, "file"), f"cannot read {brief(curve.file)}: {error}", "a CSV file beside the config")
            else:
                experiment.output.measured[probe] = curve.model_copy(update={"samples": samples, "file": Path(curve.file).name})


def content(path: Path) -> str:
    """The text of a plain file of at most MOST_BYTES. Never waits: a pipe and a device are not opened for reading."""
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
        found = os.fstat(file.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise Unreadable(0, "this is no plain file", "a CSV file with a header and numbers, not a pipe, device or folder")
        raw = file.read(MOST_BYTES + 1) if found.st_size <= MOST_BYTES else b""
    if (not raw and found.st_size) or len(raw) > MOST_BYTES:
        raise Unreadable(0, f"the file has {max(found.st_size, len(raw)) / 2**20:.0f} MiB", f"at most {MOST_BYTES // 2**20} MiB")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise Unreadable(raw.count(b"\n", 0, error.start) + 1, f"this is not UTF-8 text (byte 0x{raw[error.start]:02x})", "a CSV file in UTF-8") from None


def fields(number: int, line: str) -> list[str]:
    """The fields of one line."""
    try:
        return [field.strip() for field in next(csv.reader([line], strict=True))]
    except csv.Error as error:
        raise Unreadable(number, f"this is not CSV: {error}", "fields between commas, each row on a line of its own") from None


def read(path: Path, time: str, value: str) -> list[tuple[float, float]]:
    """(second, kelvin) of every row, by rising time; Unreadable for what is wrong, and where."""
    text = content(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    lines = [(number, line) for number, line in enumerate(text, 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise Unreadable(1, "the file is empty", "a header and rows of numbers")
    head, names = lines[0][0], fields(*lines[0])
    suffix = next((suffix for suffix in KELVIN if value.endswith(suffix)), None)
    for key, name, known, right in (("value", value, suffix is not None, [n for n in names if n.endswith(tuple(KELVIN))]),
                                    ("time", time, time in SECONDS, [n for n in names if n in SECONDS])):  # fmt: skip
        if name not in names or not known:
            want = "a column whose name ends in _degC or _K" if key == "value" else f"a column named {', '.join(SECONDS)}"
            raise Unreadable(head, f"no such column: {name!r}", right or f"{want}; here are {brief(listed(names))}", key)
        if names.count(name) > 1:
            raise Unreadable(head, f"two columns are called {name!r}", "each name once", key)
    if len(lines) == 1:
        raise Unreadable(head + 1, "no rows follow the header", "a row for each measurement")
    if len(lines) > MOST_ROWS + 1:
        raise Unreadable(lines[MOST_ROWS + 1][0], f"more than {MOST_ROWS} rows", "fewer: every point of a sweep carries the curve; keep every tenth row, say")
    at = names.index(time), names.index(value)
    return sorted((pair(number, fields(number, line), names, at, time, suffix) for number, line in lines[1:]), key=lambda row: row[0])


def pair(number: int, row: list[str], names: list[str], at: tuple[int, int], time: str, suffix: str) -> tuple[float, float]:
    """(second, kelvin) of one row."""
    if len(row) != len(names):
        raise Unreadable(number, f"{len(row)} fields under a header of {len(names)}", "as many fields as the header has")
    second, kelvin = (figure(number, row[k], names[k]) for k in at)
    second, kelvin = second * SECONDS[time], kelvin + KELVIN[suffix]
    if second < 0:
        raise Unreadable(number, "a time before the start of the run", "0 or later")
    if kelvin < 0:
        raise Unreadable(number, f"{kelvin:g} K, below absolute zero", "a temperature in the column's unit")
    return second, kelvin


def figure(number: int, text: str, name: str) -> float:
    """One number."""
    try:
        found = math.nan if "_" in text else float(text)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise Unreadable(number, f"{name} is no finite number: {brief(text)}", "a number")
    return found
