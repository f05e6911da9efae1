"""Curves in CSV files as laboratories and bakers write them: named columns, units in the header, clock times, decimal commas, lines before the header.

Header      the first line with the columns that are asked for (lines before it are passed over: the exports of wireless probes have nine); # begins a comment
Fields      between commas, semicolons or tabs, whichever the header has; where it is not the comma, a comma in a number is its decimal sign
Time        a column called second, minute, hour (or s, min, h, time, timestamp, elapsed, with a unit in brackets or behind _), or the one that is named;
            numbers, clock times (12:30, 12:30:05, 1:30 PM; minutes and seconds under [mm:ss]), or dates with one (2026-05-01 12:30:05, 01.05.2026 12:30), which
            count from the first row or from `start`. Without dates, a clock that goes back by half a day or more has passed midnight. A probe's export counts
            seconds
Value       its unit stands behind the last _ or in brackets, or is given; temperatures of a probe's export are in degC
Rows may stand in any order of time; they are kept by rising time. Everything else that is not plain is refused with its line.
"""

import csv
import datetime
import math
import os
import re
import stat
from pathlib import Path
from typing import Any

from mpm.config.problems import brief, listed

SECONDS = {"second": 1.0, "minute": 60.0, "hour": 3600.0}
LIKE_TIME = re.compile(r"(?:time|timestamp|elapsed|t|zeit|clock)?\W*_?(?:time)?", re.IGNORECASE)
TIMES = {"second": 1.0, "seconds": 1.0, "sec": 1.0, "s": 1.0, "minute": 60.0, "minutes": 60.0, "min": 60.0, "hour": 3600.0, "hours": 3600.0, "h": 3600.0,
         "ms": 1e-3, "day": 86400.0, "days": 86400.0, "d": 86400.0}  # fmt: skip
CLOCK = re.compile(r"(?:(?P<date>\d{4}-\d{2}-\d{2}|\d{1,2}\.\d{1,2}\.\d{4}),?[T ]\s*)?(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,]\d+)?))?"
                   r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?(?P<zone>Z|[+-]\d{2}:?\d{2})?")  # fmt: skip
DEGREES = {"c": "degC", "celsius": "degC", "deg c": "degC", "f": "degF", "fahrenheit": "degF", "deg f": "degF"}  # as people write them in a header
LETTERS = set("°µ²³äöüÄÖÜßéèàç".encode("cp1252"))  # of files that a spreadsheet wrote in Windows-1252
MOST_BYTES, MOST_ROWS, MOST_BEFORE = 64 * 2**20, 100_000, 30  # of a file; of its curve, which every point carries; lines before the header
EXPORT = "Combustion Inc"  # begins the export of a wireless eight-sensor probe


class Unreadable(ValueError):
    """What is wrong with a file, and what would be right. `column`: the key of the config that names it, where it is a column's name that is wrong."""

    def __init__(self, line: int, message: str, allowed: Any = "", column: str = "file"):
        super().__init__(f"line {line}: {message}" if line else message)
        self.line, self.message, self.allowed, self.column = line, message, allowed, column


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


def fields(number: int, line: str, sign: str) -> list[str]:
    """The fields of one line."""
    try:
        return [field.strip() for field in next(csv.reader([line], strict=True, delimiter=sign))]
    except csv.Error as error:
        raise Unreadable(number, f"this is not CSV: {error}", "fields between commas, each row on a line of its own") from None


def unit_of(name: str) -> str:
    """The unit that a header tells: in brackets, or behind the last _; empty where there is neither."""
    if found := re.search(r"[\[(]([^\])]+)[\])]\s*$", name):
        return found[1].strip()
    return name.rpartition("_")[2] if "_" in name else ""


def seconds_of(name: str) -> float | None:
    """How many seconds one in a column of this name is; NaN where its name says time and no unit; None where it says no time."""
    if name.lower() in TIMES:
        return TIMES[name.lower()]
    unit = unit_of(name)
    if re.fullmatch(r"(h+:)?m+:s+|h+:m+", unit.lower()):
        return math.nan
    stem = re.sub(r"[\[(][^\])]*[\])]\s*$", "", name) if not name.rstrip().endswith(unit) else name.removesuffix(unit)
    if unit.lower() in TIMES and LIKE_TIME.fullmatch(stem.strip(" _") or ""):
        return TIMES[unit.lower()]
    return math.nan if re.fullmatch(r"time|timestamp|elapsed|clock|zeit", name, re.IGNORECASE) else None


def header(lines: list[tuple[int, str]], time: str, value: str) -> tuple[int, list[str], str]:
    """(place among the lines, names of the columns, sign between fields) of the first line that has the columns, else of the first line."""
    first = None
    for place, (number, line) in enumerate(lines[: MOST_BEFORE + 1]):
        for sign in ",;\t":
            if place and line.count(sign) == 0:
                continue
            names = fields(number, line, sign) if not place or value in line else []
            first = first or (place, names, sign)
            if value in names and (not time or time in names):
                return place, names, sign
    return first


def read(path: Path, time: str, value: str, units: str, unit: str = "", start: Any = None, sigma: str = "") -> list[tuple[float, ...]]:
    """(second, value in `units`[, sigma]) of every row, by rising time; Unreadable for what is wrong, and where."""
    text = content(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    lines = [(number, line) for number, line in enumerate(text, 1) if line.strip() and not line.startswith("#")]
    if not lines:
        raise Unreadable(1, "the file is empty", "a header and rows of numbers")
    place, names, sign = header(lines, time, value)
    head, probe = lines[place][0], lines[0][1].startswith(EXPORT)
    named, time = bool(time), time or next((name for name in names if seconds_of(name) is not None), "")
    scale = seconds_of(time) if time in names else None
    if scale is None and named and time in names:  # whoever names a column knows that it is the time
        scale = TIMES.get(unit_of(time).lower(), math.nan)
    others = [name for name in names if name and seconds_of(name) is None and name != sigma]
    value = value or (others[0] if len(others) == 1 else "")
    if value not in names:
        said = f"no such column: {value!r}" if value else "which column is it? Name it by `value`"
        raise Unreadable(head, said, [n for n in names if seconds_of(n) is None] or listed(names), "value")
    if time not in names or scale is None:
        right = [n for n in names if seconds_of(n) is not None]
        raise Unreadable(head, f"no such column: {time!r}", right or f"a column named {', '.join(SECONDS)}; here are {brief(listed(names))}", "time")
    if sigma and sigma not in names:
        raise Unreadable(head, f"no such column: {sigma!r}", names, "sigma")
    for key, name in (("value", value), ("time", time), ("sigma", sigma)):
        if name and names.count(name) > 1:
            raise Unreadable(head, f"two columns are called {name!r}", "each name once", key)
    rows = lines[place + 1 :]
    if not rows:
        raise Unreadable(head + 1, "no rows follow the header", "a row for each measurement")
    if len(rows) > MOST_ROWS:
        raise Unreadable(rows[MOST_ROWS][0], f"more than {MOST_ROWS} rows", "fewer: every point of a sweep carries the curve; keep every tenth row, say")
    line = Line(head, names, sign, names.index(time), names.index(value), names.index(sigma) if sigma else None)
    line.scale = 1.0 if probe and math.isnan(scale) else scale
    line.convert = conversion(head, value, units, unit or ("degC" if probe and not unit_of(value) else ""), "value")
    line.error = conversion(head, sigma, units, "", "sigma", difference=True) if sigma else None
    found = [line.numbers(number, fields(number, row, sign)) for number, row in rows]
    origin = line.origin(start, min(second for second, *_ in found)) if line.clock or start is not None or probe else 0.0
    shifted = [(number, (row[0] - origin, *row[1:])) for (number, _), row in zip(rows, found, strict=True)]
    kept = [(number, row) for number, row in shifted if row[0] >= 0 or start is None]
    if not kept:
        raise Unreadable(head, "no row is at the start of the run or later", "an earlier `start`", "start")
    for number, row in kept:
        if row[0] < 0:
            raise Unreadable(number, "a time before the start of the run", "0 or later, or `start`: what the column shows when the run begins")
        if units == "K" and row[1] < 0:
            raise Unreadable(number, f"{row[1]:g} K, below absolute zero", "a temperature in the column's unit")
        if len(row) > 2 and not row[2] > 0:
            raise Unreadable(number, f"{sigma} is not above 0", "a standard error")
    return sorted((row for _, row in kept), key=lambda row: row[0])


class Line:
    """How one row becomes numbers."""

    def __init__(self, head: int, names: list[str], sign: str, time: int, value: int, sigma: int | None):
        self.head, self.names, self.sign, self.at = head, names, sign, (time, value, sigma)
        self.clock = False  # whether a clock time was seen
        self.days, self.last = 0, None  # of clock times without a date
        self.short = re.fullmatch(r"m+:s+", unit_of(names[time]).lower()) is not None
        self.scale, self.convert, self.error = 1.0, None, None

    def numbers(self, number: int, row: list[str]) -> tuple[float, ...]:
        """(second, value[, sigma]) of one row."""
        if len(row) != len(self.names):
            raise Unreadable(number, f"{len(row)} fields under a header of {len(self.names)}", "as many fields as the header has")
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
        self.clock = True
        hour, minute, second = int(match["hour"]), int(match["minute"]), float((match["second"] or "0").replace(",", "."))
        if self.short and match["second"] is None:
            return hour * 60.0 + minute  # mm:ss
        date = "-".join(part.zfill(2) for part in reversed((match["date"] or "").split(".")) if part)
        try:
            days = datetime.date.fromisoformat(date).toordinal() if date else self.days
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
        plain = text.replace(",", ".") if self.sign != "," and text.count(",") == 1 and "." not in text else text
        try:
            found = math.nan if "_" in text else float(plain)
        except ValueError:
            found = math.nan
        if not math.isfinite(found):
            twice = self.sign == "," and re.fullmatch(r"-?\d+,\d+", text)  # 20,5 or 1,000
            raise Unreadable(number, f"{name} is no finite number: {brief(text)}", "20.5, or semicolons between the fields" if twice else "a number")
        return found


def conversion(head: int, name: str, units: str, given: str, key: str, difference: bool = False) -> Any:
    """From numbers of a column to SI: a function of one number."""
    from mpm.config.units import UnitError, convert

    unit = given or unit_of(name)
    unit = DEGREES.get(unit.lower().lstrip("°"), unit) if units == "K" else unit
    if not unit and units != "1":
        raise Unreadable(head, f"the column {name!r} tells no unit", f"a name that ends in one, as {name}_degC, or `unit: degC`" if units == "K" else
                         f"a name with one of the dimension of {units}, as {name} [{units}], or `unit: {units}`", key)  # fmt: skip
    try:
        zero, one = (convert(f"{k} {unit or '1'}", units, "value", difference) for k in (0, 1))
    except UnitError as error:
        if units == "1" and not given:
            return lambda number: number
        words = f"the unit of the column {name!r}: {error}"
        raise Unreadable(head, words, f"a unit of the dimension of {units}", "unit" if given else key) from None
    if unit in ("degC", "°C", "K", "kelvin"):  # exact: 20 degC is 20 + 273.15
        return lambda number: number + zero if not difference else number
    return lambda number: number * (one - zero) + zero
