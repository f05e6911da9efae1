"""The header of a CSV file: which line it is, what stands between fields, which column is the time, and which units the names tell.

Line        the first with the columns that are asked for, else the first with a column that says time, else the first that has several fields
Unit        in brackets (`Core [°F]`, `Time(min)`), behind _ (`core_degC`), a stroke (`T / °C`) or a comma (`"Core, °F"`), or in a row of units below the names
"""

import csv
import math
import re
from typing import Any

LIKE_TIME = re.compile(r"(?:(?:.*[\W_])?(?:time|timestamp|elapsed|clock|\w*zeit|t))?", re.IGNORECASE)
NO_UNIT = re.compile(r"(?:time|timestamp|elapsed|elapsed time|clock|clock time|zeit|uhrzeit|date ?/? ?time|datum ?/? ?(?:uhr)?zeit)", re.IGNORECASE)
DAYS = re.compile(r"date|datum|day|tag", re.IGNORECASE)
TIMES = {"second": 1.0, "seconds": 1.0, "sec": 1.0, "secs": 1.0, "s": 1.0, "sekunde": 1.0, "sekunden": 1.0, "sek": 1.0, "minute": 60.0, "minutes": 60.0,
         "min": 60.0, "mins": 60.0, "minuten": 60.0, "hour": 3600.0, "hours": 3600.0, "h": 3600.0, "hr": 3600.0, "hrs": 3600.0, "stunde": 3600.0,
         "stunden": 3600.0, "ms": 1e-3, "msec": 1e-3, "day": 86400.0, "days": 86400.0, "d": 86400.0}  # fmt: skip
BRACKET = re.compile(r"(?:\[([^\[\]]+)\]|\(((?:[^()]|\([^()]*\))+)\))\s*$")
SHORT = re.compile(r"m+:s+", re.IGNORECASE)  # minutes and seconds
CLOCKED = re.compile(r"(h+:)?m+:s+|h+:m+", re.IGNORECASE)
MOST_BEFORE = 30  # lines before the header
EXPORT = "Combustion Inc"  # begins the export of a wireless eight-sensor probe
EXPORTED = {"Timestamp", "SessionID", "SequenceNumber", "T1"}  # or has these columns


class Unreadable(ValueError):
    """What is wrong with a file, and what would be right. `column`: the key of the config that names it, where it is a column's name that is wrong."""

    def __init__(self, line: int, message: str, allowed: Any = "", column: str = "file"):
        super().__init__(f"line {line}: {message}" if line else message)
        self.line, self.message, self.allowed, self.column = line, message, allowed, column


def fields(number: int, line: str, sign: str) -> list[str]:
    """The fields of one line."""
    try:
        return [field.strip() for field in next(csv.reader([line], strict=True, delimiter=sign, skipinitialspace=True))]
    except csv.Error as error:
        raise Unreadable(number, f"this is not CSV: {error}", "fields between commas, each row on a line of its own") from None


def units_of(name: str) -> list[str]:
    """The units that a name may tell, the likeliest first."""
    if bracket := BRACKET.search(name):
        return [(bracket[1] or bracket[2]).strip()]
    found = [name.rpartition("_")[2].strip()] if "_" in name else []
    found += [name.partition(sign)[2].strip() for sign in "/," if sign in name]
    if degrees := re.search(r"(?:°|\bdeg\.? ?)[CF]$", name):
        found.append(degrees[0])
    return [unit for unit in found if unit]


def unit_of(name: str) -> str:
    """The likeliest of them; empty where there is none."""
    return next(iter(units_of(name)), "")


def seconds_of(name: str) -> float | None:
    """How many seconds one in a column of this name is; NaN where its name says time and no unit; None where it says no time."""
    if name.lower() in TIMES:
        return TIMES[name.lower()]
    if NO_UNIT.fullmatch(name):
        return math.nan
    for unit in (*units_of(name), name.rpartition(" ")[2]):
        if CLOCKED.fullmatch(unit):
            return math.nan
        bracket = BRACKET.search(name)
        stem = name[: bracket.start()] if bracket else name.removesuffix(unit)
        if unit.lower() in TIMES and ((bracket and unit.lower() != "d") or LIKE_TIME.fullmatch(stem.strip(" _/,"))):
            return TIMES[unit.lower()]
    return None


def column(said: str, names: list[str]) -> str:
    """The column that is meant: of that name, else the only one of that name before a unit in brackets (`core`: `core [°F]`); as said where there is none."""
    alike = [name for name in names if BRACKET.sub("", name).strip() == said]
    return alike[0] if said and said not in names and len(alike) == 1 else said


def header(lines: list[tuple[int, str]], time: str, value: str) -> tuple[int, list[str], str]:
    """(place among the lines, names of the columns, sign between fields)."""
    several = timed = first = None
    wrong: Unreadable | None = None
    for place, (number, line) in enumerate(lines[: MOST_BEFORE + 1]):
        for sign in ",;\t":
            if sign not in line and place:
                continue
            try:
                names = fields(number, line, sign)
            except Unreadable as error:
                wrong = wrong or error
                continue
            found = place, names, sign
            if value and column(value, names) in names and (not time or column(time, names) in names):
                return found
            first = first or found
            if len(names) > 1:
                several = several or found
                if (column(time, names) in names) if time else any(seconds_of(name) is not None for name in names):
                    timed = timed or found
    best = timed or several or first
    if best is None:
        assert wrong is not None  # the first line is tried with every sign
        raise wrong
    return best


def with_units(names: list[str], row: list[str]) -> list[str] | None:
    """The names with the units of the row below them, as `time;T` over `min;°C`; None where that row is no row of units."""
    units = [cell.strip("[]() ") for cell in row]
    if len(row) != len(names) or not any(unit.lower() in TIMES or CLOCKED.fullmatch(unit) for unit in units) or any(re.search(r"^[-+]?\d", u) for u in units):
        return None
    return [f"{name} [{unit}]" if unit else name for name, unit in zip(names, units, strict=True)]


def is_export(first: str, names: list[str]) -> bool:
    """Whether the file is the export of a wireless eight-sensor probe: it counts seconds, in degrees Celsius."""
    return first.lstrip("# ").startswith(EXPORT) or set(names) >= EXPORTED
