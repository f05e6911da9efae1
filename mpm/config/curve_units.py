"""Units of the columns of CSV files: of a header or as given, as people write them, to SI."""

import contextlib
import re
from collections.abc import Callable

from mpm.config.headers import BRACKET, Unreadable, units_of

DEGREES = {f"{word}{unit}": f"deg{unit.upper()}" for unit in "cf" for word in ("", "deg ", "deg. ", "degree ", "degrees ")}  # as people write them in a header
DEGREES |= {"℃": "degC", "℉": "degF", "celsius": "degC", "fahrenheit": "degF", "degrees celsius": "degC", "degrees fahrenheit": "degF"}


def ends(unit: str, units: str, difference: bool = False) -> tuple[float, float]:
    """What 0 and 1 of a column are in SI; UnitError."""
    from mpm.config.units import convert

    return convert(f"0 {unit}", units, "value", difference), convert(f"1 {unit}", units, "value", difference)


def plain_unit(unit: str, units: str) -> str:
    """A unit as people write it in a header, as it is read here."""
    return DEGREES.get(re.sub("[°º˚]", "", unit).strip().lower(), unit) if units == "K" else "1" if unit == "-" else unit


def contradicted(name: str, given: str, units: str) -> bool:
    """Whether a column's name tells another unit of the dimension than the one that is given."""
    from mpm.config.units import UnitError

    for unit in units_of(name):
        with contextlib.suppress(UnitError):
            return ends(plain_unit(unit, units), units) != ends(plain_unit(given, units), units)
    return False


def conversion(head: int, name: str, units: str, given: str, key: str, like: str | None = None) -> Callable[[float], float]:
    """From numbers of a column to SI: a function of one number. `like`: the unit of the values that these are standard errors of."""
    from mpm.config.units import UnitError

    difference = like is not None
    if given and key == "value" and contradicted(name, given, units):
        raise Unreadable(head, f"the column {name!r} tells a unit of its own, and `unit` says {given}", "one of the two", "unit")
    told = [unit for unit in ([given] if given else [*units_of(name), like]) if unit]
    if not told and units != "1":
        raise Unreadable(head, f"the column {name!r} tells no unit", f"a name that ends in one, as {name}_degC, or `unit: degC`" if units == "K" else
                         f"a name with one of the dimension of {units}, as {name} [{units}], or `unit: {units}`", key)  # fmt: skip
    wrong = None
    for unit in told or ["1"]:
        unit = plain_unit(unit, units)
        try:
            zero, one = ends(unit, units, difference)
            break
        except UnitError as error:
            wrong = wrong or error
    else:
        if units == "1" and not given and not BRACKET.search(name):  # `lateral_strain` ends in no unit
            return lambda number: number
        force = ", as gf where a force is told in grams" if units == "N" else ""
        words = f"the unit of the column {name!r}: {wrong}"
        raise Unreadable(head, words, f"a unit of the dimension of {units}{force}", "unit" if given else key) from None
    if unit in ("degC", "°C", "K", "kelvin"):  # exact: 20 degC is 20 + 273.15
        return lambda number: number + zero if not difference else number
    return lambda number: number * (one - zero) + zero
