"""Curves in CSV files as laboratories and bakers write them: named columns, units in the header, clock times, decimal commas, lines before the header.

Header      see `headers`; lines before it are passed over (the exports of wireless probes have nine); # begins a comment
Fields      between commas, semicolons or tabs, whichever the header has. A comma within a number is its decimal sign; between commas such a number stands in
            quotes, and three digits behind the comma (1,000) are refused there, as they may be thousands
Time        a column called second, minute, hour (or s, min, h, time, timestamp, elapsed, with a unit in brackets or behind _), or the one that is named;
            numbers, minutes and seconds (12:30 under [mm:ss] and in columns of minutes), clock times (12:30, 12:30:05, 1:30 PM), or dates with one
            (2026-05-01 12:30:05, 01.05.2026 12:30, 5/1/2026 12:30 PM). Clock times count from the first row or from `start`; without dates, a clock that goes
            back by half a day or more has passed midnight. A probe's export counts seconds
Value       its unit stands in the header, or is given; temperatures of a probe's export are in degC
Rows may stand in any order of time; they are kept by rising time. A row that has neither time nor value is passed over: another curve of the file is longer.
Everything else that is not plain is refused with its line.
"""

import datetime
import math
import os
import re
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from mpm.config.curve_units import conversion
from mpm.config.headers import DAYS, SHORT, TIMES, Unreadable, column, fields, header, is_export, seconds_of, unit_of, with_units
from mpm.config.problems import brief, listed

DATE = r"(?:(?P<date>\d{4}[-/]\d{2}[-/]\d{2}|\d{1,2}[./]\d{1,2}[./](?:\d{4}|\d{2})),?[T ]\s*)?"
CLOCK = re.compile(DATE + r"(?P<hour>\d{1,3}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,]\d+)?))?(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
                   r"(?P<zone>Z|[+-]\d{2}:?\d{2})?")  # fmt: skip
SLASHED = re.compile(r"(\d{1,2})/(\d{1,2})/\d{2,4}\b")
LETTERS = set("°ºµ²³äöüÄÖÜßéèàç".encode("cp1252"))  # of files that a spreadsheet wrote in Windows-1252
MOST_BYTES, MOST_ROWS = 64 * 2**20, 100_000  # of a file; of its curve, which every point carries


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
        return raw.decode("utf-16" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError as error:
        if {byte for byte in raw if byte > 127} <= LETTERS:
            return raw.decode("cp1252")
        raise Unreadable(raw.count(b"\n", 0, error.start) + 1, f"this is not UTF-8 text (byte 0x{raw[error.start]:02x})", "a CSV file in UTF-8") from None


def read(path: Path, time: str, value: str, units: str, unit: str = "", start: Any = None, sigma: str = "") -> list[tuple[float, ...]]:
    """(second, value in `units`[, sigma]) of every row, by rising time; Unreadable for what is wrong, and where."""
    lines = written(content(path))
    found = columns(lines, time, value, sigma)
    head, rows = found.head, lines[found.below :]
    if not rows:
        raise Unreadable(head + 1, "no rows follow the header", "a row for each measurement")
    if len(rows) > MOST_ROWS:
        raise Unreadable(rows[MOST_ROWS][0], f"more than {MOST_ROWS} rows", "fewer: every point of a sweep carries the curve; keep every tenth row, say")
    probe = is_export(lines[0][1], found.names)
    reader = RowReader(found)
    reader.scale = 1.0 if probe and math.isnan(found.scale) else found.scale
    reader.convert = conversion(head, found.value, units, unit or ("degC" if probe and not unit_of(found.value) else ""), "value")
    if sigma:
        reader.error = conversion(head, found.sigma, units, "", "sigma", unit or unit_of(found.value))
    split = [(number, reader.whole(number, fields(number, row, found.sign))) for number, row in rows]
    filled = [(number, row) for number, row in split if row[found.at[0]] or row[found.at[1]]]
    if not filled:
        raise Unreadable(head + 1, "no row has a time and a value", "a row for each measurement")
    reader.day_first = day_first([(number, row[found.at[0]]) for number, row in filled])
    each = [reader.numbers(number, row) for number, row in filled]
    origin = reader.origin(start, min(second for second, *_ in each)) if reader.clock or start is not None or probe else 0.0
    shifted = [(number, (row[0] - origin, *row[1:])) for (number, _), row in zip(filled, each, strict=True)]
    kept = [(number, row) for number, row in shifted if row[0] >= 0 or start is None]
    if not kept:
        raise Unreadable(head, "no row is at the start of the run or later", "an earlier `start`", "start")
    for number, row in kept:
        check(number, row, units, sigma)
    return sorted((row for _, row in kept), key=lambda row: row[0])


def written(text: str) -> list[tuple[int, str]]:
    """Lines with their numbers, without empty ones and comments; where numbers begin at once, the last comment above them is the header."""
    every = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    lines = [(number, line) for number, line in enumerate(every, 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise Unreadable(1, "the file is empty", "a header and rows of numbers")
    commented = [(number, line.lstrip("# ")) for number, line in enumerate(every[: lines[0][0]], 1) if line.startswith("#")]
    return lines if not commented or re.search(r"[^\W\d_eE]", lines[0][1]) else [commented[-1], *lines]


class Columns(NamedTuple):
    """What a header tells. Names of the three columns are with their units, `at` their places; no sigma: "" and None."""

    head: int  # number of its line
    below: int  # of `lines`, where rows begin
    names: list[str]
    sign: str  # between fields
    time: str
    value: str
    sigma: str
    at: tuple[int, int, int | None]
    scale: float  # seconds of the time column's unit; NaN: clock times only


def columns(lines: list[tuple[int, str]], time: str, value: str, sigma: str) -> Columns:
    """The columns of time, value and standard error, by the names given or, where those are empty, by what the header allows."""
    place, names, sign = header(lines, time, value)
    head, named = lines[place][0], bool(time)
    time, value, sigma = (column(said, names) for said in (time, value, sigma))
    told = with_units(names, fields(*lines[place + 1], sign)) if place + 1 < len(lines) else None  # a row of units below the names
    full = dict(zip(names, told or names, strict=True))
    time = time or timed(names, names) or timed(names, told or names)
    scale = seconds_of(full[time]) if time in names else None
    if scale is None and named and time in names:  # whoever names a column knows that it is the time
        scale = TIMES.get(unit_of(time).lower(), math.nan)
    others = [name for name in names if name and seconds_of(full[name]) is None and name != sigma and not DAYS.fullmatch(name)]
    value = value or (others[0] if len(others) == 1 else "")
    if value not in names:
        said = f"no such column: {value!r}" if value else "which column is it? Name it by `value`"
        raise Unreadable(head, said, others or listed(names), "value")
    if time not in names or scale is None:
        right = [name for name in names if seconds_of(name) is not None]
        raise Unreadable(head, f"no such column: {time!r}", right or f"a column named second, minute, hour; here are {brief(listed(names))}", "time")
    if sigma and sigma not in names:
        raise Unreadable(head, f"no such column: {sigma!r}", names, "sigma")
    for key, name in (("value", value), ("time", time), ("sigma", sigma)):
        if name and names.count(name) > 1:
            raise Unreadable(head, f"two columns are called {name!r}", "each name once", key)
    at = (names.index(time), names.index(value), names.index(sigma) if sigma else None)
    return Columns(head, place + 1 + (told is not None), names, sign, full[time], full[value], full.get(sigma, ""), at, scale)


def timed(names: list[str], full: list[str]) -> str:
    """The first column whose name with its unit tells seconds; "" where none does."""
    return next((name for name, told in zip(names, full, strict=True) if seconds_of(told) is not None), "")


def check(number: int, row: tuple[float, ...], units: str, sigma: str) -> None:
    """Refuse a time before the start, a temperature below absolute zero and a standard error that is none."""
    if row[0] < 0:
        raise Unreadable(number, "a time before the start of the run", "0 or later, or `start`: what the column shows when the run begins")
    if units == "K" and row[1] < 0:
        raise Unreadable(number, f"{row[1]:g} K, below absolute zero", "a temperature in the column's unit")
    if len(row) > 2 and not row[2] > 0:
        raise Unreadable(number, f"{sigma} is not above 0", "a standard error")


def day_first(rows: list[tuple[int, str]]) -> bool:
    """Whether dates between strokes are day/month/year, as one of them must tell; where all are of one day it does not matter."""
    found = [(number, match) for number, text in rows if (match := SLASHED.match(text))]
    if any(int(match[1]) > 12 for _, match in found):
        return True
    if len({match[0] for _, match in found}) > 1 and not any(int(match[2]) > 12 for _, match in found):
        number, match = next((number, match) for number, match in found if match[0] != found[0][1][0])
        raise Unreadable(number, f"{match[0]} may be two days, and dates of this column differ", "2026-05-01 12:30, or 01.05.2026 12:30")
    return False


class RowReader:
    """How one row becomes numbers."""

    day_first = False

    def __init__(self, columns: Columns):
        self.names, self.sign, self.at = columns.names, columns.sign, columns.at
        self.clock = False  # whether a clock time was seen
        self.days = 0  # of clock times without a date
        self.last: float | None = None
        self.short = SHORT.fullmatch(unit_of(columns.time)) is not None
        self.scale = 1.0
        self.convert: Callable[[float], float] = float
        self.error: Callable[[float], float] = float

    def whole(self, number: int, row: list[str]) -> list[str]:
        """As many fields as the header has; signs at the end of a line count for nothing."""
        named, filled = self.names, row
        while filled and len(filled) > len(named) and not filled[-1]:
            filled = filled[:-1]
        filled = filled + [""] * sum(not name for name in named[len(filled) :])
        if len(filled) != len(named):
            raise Unreadable(number, f"{len(row)} fields under a header of {len(named)}", "as many fields as the header has")
        return filled

    def numbers(self, number: int, row: list[str]) -> tuple[float, ...]:
        """(second, value[, sigma]) of one row."""
        time, value, sigma = self.at
        found = (self.second(number, row[time]), self.convert(self.figure(number, row[value], self.names[value])))
        return found if sigma is None else (*found, self.error(self.figure(number, row[sigma], self.names[sigma])))

    def second(self, number: int, text: str) -> float:
        """A time in seconds."""
        if match := CLOCK.fullmatch(text):
            return self.clock_time(number, text, match)
        if math.isnan(self.scale):
            raise Unreadable(number, f"{self.names[self.at[0]]} is no clock time, and its column tells no unit: {brief(text)}",
                             "12:30:05, 2026-05-01 12:30:05, or a column named second, minute, time [min]")  # fmt: skip
        return self.figure(number, text, self.names[self.at[0]]) * self.scale

    def clock_time(self, number: int, text: str, match: Any) -> float:
        """A clock time in seconds; one without a date that goes back by half a day or more is of the next day."""
        hour, minute, second = int(match["hour"]), int(match["minute"]), float((match["second"] or "0").replace(",", "."))
        date = match["date"]
        if minute <= 59 and not date and not match["half"] and match["second"] is None and (self.short or self.scale == 60.0):
            return hour * 60.0 + minute  # mm:ss since the start
        self.clock = True
        try:
            days = self.day(date).toordinal() if date else self.days
        except ValueError as error:
            raise Unreadable(number, f"{brief(text)} is no date: {error}", "2026-05-01 12:30:05, or 01.05.2026 12:30:05") from None
        if minute > 59 or second >= 60 or ((date or match["half"]) and hour > (12 if match["half"] else 23)):  # alone, it may be a stop watch
            raise Unreadable(number, f"{brief(text)} is no time of day", "12:30:05, 1:30 PM, or 2026-05-01 12:30:05")
        if match["half"]:
            hour = hour % 12 + 12 * (match["half"] in "Pp")
        moment = 3600.0 * hour + 60.0 * minute + second
        zone = match["zone"] or "Z"
        away = 0.0 if zone == "Z" else float(zone[0] + "1") * (3600.0 * int(zone[1:3]) + 60.0 * int(zone[-2:]))
        if not date:
            if self.last is not None and moment < self.last - 43200.0:
                self.days = days = days + 1
            self.last = moment
        return days * 86400.0 + moment - away

    def day(self, text: str) -> datetime.date:
        """2026-05-01, 01.05.2026, 1.5.26, or 5/1/2026 and 1/5/2026 as the column tells."""
        first, second, third = re.split(r"[-./]", text)
        if len(first) == 4:
            return datetime.date(int(first), int(second), int(third))
        if "/" in text and not self.day_first:
            first, second = second, first
        return datetime.date(int(third) + 2000 * (len(third) == 2), int(second), int(first))

    def origin(self, start: Any, first: float) -> float:
        """The second of the column at which the run begins."""
        if start is None:
            return first
        try:
            if not isinstance(start, str):
                return float(start) * (1.0 if math.isnan(self.scale) else self.scale)
            self.days, self.last = 0, None
            begin = self.second(0, start)
            return begin - 86400.0 if begin > first + 43200.0 else begin  # the evening before
        except Unreadable:
            raise Unreadable(0, f"start is no time of the column {self.names[self.at[0]]!r}", "a number in its unit, or a clock time", "start") from None

    def figure(self, number: int, text: str, name: str) -> float:
        """One number."""
        plain = text.replace("\N{MINUS SIGN}", "-")
        thousands = self.sign == "," and re.fullmatch(r"-?\d{1,3},\d{3}", plain)  # or not: 1,000
        plain = plain.replace(",", ".") if plain.count(",") == 1 and "." not in plain and not thousands else plain
        try:
            found = math.nan if "_" in text else float(plain)
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            allowed = "1000 or 1.000, or semicolons between the fields" if thousands else "a number"
            raise Unreadable(number, f"{name} is no finite number: {brief(text)}", allowed)
        return found
