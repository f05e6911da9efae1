"""Text with a unit to SI floats, by pint; the only module that loads pint.

convert("190 degC", "K", "temperature")                          463.15
convert("1.5 degC", "K", "temperature difference", difference=True)   1.5
convert("2 mm", "m", "length")                                   0.002
convert("50 W m-2 K-1", "W/m**2/K", "heat-transfer coefficient")      50.0, as "50 W/m2/K", "50 W/m**2/K" or "50 W/(m²·K)"

Numbers and exponents are read here and only the bare unit reaches pint, so that no text can make it compute.
"""

import difflib
import functools
import gc
import re
from typing import Any

TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*", re.DOTALL)
UNIT = re.compile(r"(?:[^\W\d]|[°%Ωµμ*/^ ·().⁻⁰¹²³⁴⁵⁶⁷⁸⁹]|(?:\*\*|\^)\s*-?\s*\d{1,2}(?!\d)|^1(?=/)){1,60}")
PLAIN_POWER = re.compile(r"(?<=[^\W\d_])(-?\d{1,2})(?!\w)")  # m2, s-1: as datasets and UDUNITS write powers
ALIKE = str.maketrans({"−": "-", "⋅": "·", "∙": "·", "\xa0": " ", "\u202f": " ", "º": "°", "˚": "°", "℃": "°C", "℉": "°F"})
KNOWN = ("m cm mm um km K degC degF s ms min h day kg g m/s mm/s Pa kPa MPa GPa bar J kJ W kW N W/m/K W/m**2/K J/kg/K kJ/kg/K kg/m**3 g/cm**3 "
         "J/kg Pa*s mPa*s 1/K Pa/K rad deg rad/s rpm m/s**2 %").split()  # fmt: skip
OFFSET = {"degree_Celsius": "delta_degree_Celsius", "degree_Fahrenheit": "delta_degree_Fahrenheit"}
NAMES = {"[length]": "length", "[time]": "time", "[temperature]": "temperature", "[mass]": "mass", "dimensionless": "pure number",
         "[mass] / [length] ** 3": "density", "[mass] / [length] / [time] ** 2": "pressure", "[length] / [time]": "velocity",
         "[length] / [time] ** 2": "acceleration", "[length] ** 2": "area", "[length] ** 3": "volume", "1 / [time]": "rate",
         "[length] * [mass] / [time] ** 3 / [temperature]": "heat conductivity", "[mass] / [temperature] / [time] ** 3": "heat-transfer coefficient",
         "[length] ** 2 / [temperature] / [time] ** 2": "specific heat", "[mass] / [length] / [time]": "viscosity"}  # fmt: skip


class UnitError(ValueError):
    """Text that is no quantity of the wanted dimension."""

    def __init__(self, message: str, suggestion: str = ""):
        super().__init__(message)
        self.suggestion = suggestion


@functools.cache
def registry() -> Any:
    """pint's registry; 0.1 to 0.3 s, once."""
    import pint

    return pint.UnitRegistry()


def forget() -> None:
    """Let go of pint's registry, some megabytes; it is made again where it is asked for."""
    registry.cache_clear()
    gc.collect()


def article(noun: str) -> str:
    """`a` or `an`."""
    return "an" if noun[:1] in "aeiou" else "a"


SI = ("m", "s", "K", "kg", "Pa", "W/m/K", "W/m**2/K", "J/kg/K", "kg/m**3", "Pa*s", "J/kg", "J", "W", "N", "W/m**2", "W/m**3", "m/s", "m/s**2", "1/s", "1/K",
      "Pa/K", "m**2", "m**3", "m**2/s")  # fmt: skip


@functools.lru_cache(4096)
def si(text: str) -> str:
    """The SI unit, as configs write it, of the same dimension as the unit in a text; UnitError where it has none that is known."""
    wrong = UnitError("")
    for unit in SI:
        try:
            convert(text, unit, "parameter")
        except UnitError as error:
            wrong = error
        else:
            return unit
    units, parts = registry(), TEXT.fullmatch(text)
    try:
        given = units.parse_units(PLAIN_POWER.sub(r"**\1", parts[2].translate(ALIKE))) if parts and UNIT.fullmatch(parts[2]) else None
    except Exception:  # as in `convert`
        given = None
    found = "" if given is None else f"{units.Quantity(1, given).to_base_units().units:~}".replace(" ", "")
    if not found:  # a share, as %
        raise wrong
    return found


def alike(one: str, two: str) -> bool:
    """Whether two SI units have one dimension."""
    units = registry()
    parse = lambda unit: units.parse_units(PLAIN_POWER.sub(r"**\1", unit) if unit not in ("", "1") else "dimensionless")  # noqa: E731
    return parse(one).dimensionality == parse(two).dimensionality


@functools.lru_cache(4096)
def convert(text: str, unit: str, name: str, difference: bool = False) -> float:
    """The number in `text` converted to `unit`; `difference` reads degC and degF as differences."""
    found = TEXT.fullmatch(text)
    if not found:
        raise UnitError(f"{text!r} is not {article(name)} {name}: it does not begin with a number")
    number, given = float(found[1]), found[2].translate(ALIKE)
    slip = f'"{found[1]} {unit}"' if len(unit) > 2 and given != unit and re.sub(r"\W", "", given) == re.sub(r"\W", "", unit) else ""  # W/mK for W/m/K
    if not given:
        raise UnitError(f"{text!r} is text without a unit, not {article(name)} {name}", suggestion=found[1])
    given = "dimensionless" if given == "1" else PLAIN_POWER.sub(r"**\1", given)
    if not UNIT.fullmatch(given):
        raise UnitError(f"{found[2]!r} is not a unit", suggestion=slip)
    if re.search(r"(\^|\*\*)[^*^]*\d\s*(\^|\*\*)", given):
        raise UnitError(f"{found[2]!r} is not a unit: powers of powers")
    units = registry()
    try:
        source = units.parse_units("1" + given if given[0] == "/" else given)
    except Exception:  # pint lets through whatever its tokenizer and evaluator raise on broken text
        near = [unit for unit in KNOWN if unit.lower() == given.lower()] or difflib.get_close_matches(given, KNOWN, 1, 0.6)
        raise UnitError(f"unknown unit {found[2]!r}", suggestion=slip or (f'"{found[1]} {near[0]}"' if near else "")) from None
    if difference and str(source) in OFFSET:
        source = units.parse_units(OFFSET[str(source)])
    target = units.parse_units(PLAIN_POWER.sub(r"**\1", unit) if unit not in ("", "1") else "dimensionless")
    if source.dimensionality != target.dimensionality:
        said = NAMES.get(str(source.dimensionality), "")
        said = f"is {article(said)} {said}" if said else f"has the dimension {source.dimensionality}"
        scale = f'"{found[1]} deg{given[-1]}"' if re.fullmatch(r"(deg\.? ?|° )?[CF]", given) and unit == "K" else slip
        raise UnitError(f"{text!r} {said}, but {article(name)} {name} is expected", suggestion=scale)
    if unit in ("", "1", "rad") and ("radian" in str(units.Quantity(1, source).to_base_units().units)) != (unit == "rad") and given != "dimensionless":
        raise UnitError(f"{text!r} is {'a share' if unit == 'rad' else 'an angle'}, but {article(name)} {name} is expected")
    if unit == "rad/s" and "hertz" in str(source):  # which is 1/s to pint
        turns = units.Quantity(number, source).to("1/s").magnitude
        raise UnitError(f"{text!r} may be turns or radians a second", suggestion=f'"{60 * turns:g} rpm"')
    if unit == "K" and not difference and "delta_" in str(source):
        said = f"{text!r} is a temperature difference, but {article(name)} {name} is expected"
        raise UnitError(said, suggestion=f'"{found[1]} deg{"F" if "Fahrenheit" in str(source) else "C"}"')
    # 36 * 0.001 is not 0.036: rounding makes "36 mm" and 0.036 the same run
    return float(f"{units.Quantity(number, source).to(target).magnitude:.15g}")
