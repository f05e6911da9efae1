"""Words on figures: symbols, units, numbers, and the unit that a reader wants (minutes, millimetres, degrees Celsius)."""

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm.text import visible

KELVIN = 273.15
SYMBOLS = {"kappa": "κ", "beta": "β", "alpha": "α", "eta": "η", "p0": "p₀", "nu": "ν", "mu": "μ", "lam": "λ", "gamma": "γ"}
LONGEST = 24  # letters of a unit
ENERGIES = ("J", "J/m", "J/m2")
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_TEMPERATURES = ("temperature", "outside", "reference", "at")  # last words of config paths that name a temperature, not a difference


@dataclass(frozen=True)
class Scale:
    """From what a dataset holds to what a figure shows: `shown = stored * factor + shift`, in `units`."""

    factor: float = 1.0
    shift: float = 0.0
    units: str = ""

    def __call__(self, values: Any) -> np.ndarray:
        return np.asarray(values, dtype=float) * self.factor + self.shift


def units_text(units: str) -> str:
    """`W/m2/K` -> `W/m²/K`, `Pa*s` -> `Pa s`, `1` -> nothing."""
    if units in ("1", ""):
        return ""
    plain = visible(units).replace("**", "").replace("^", "").replace("*", " ")
    plain = plain if len(plain) <= LONGEST else plain[: LONGEST - 1] + "…"
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda found: found[0].translate(_RAISED), plain)


def scale(values: Any, units: str, temperature: bool = False) -> Scale:
    """The unit in which `values` read best. Kelvin become degrees Celsius only where they are a temperature: an error in kelvin stays."""
    if temperature and units == "K":
        return Scale(1.0, -KELVIN, "°C")
    finite = np.abs(np.asarray(values, dtype=float))
    finite = finite[np.isfinite(finite)]
    top = float(finite.max()) if finite.size else 0.0
    steps = {
        "s": ((3 * 3600.0, 1 / 3600, "h"), (599.0, 1 / 60, "min"), (0.05, 1.0, "s"), (5e-5, 1e3, "ms"), (0.0, 1e6, "µs")),
        "m": ((0.2, 1.0, "m"), (2e-4, 1e3, "mm"), (2e-7, 1e6, "µm"), (0.0, 1e9, "nm")),
        "m3": ((0.1, 1.0, "m³"), (5e-4, 1e3, "L"), (1e-7, 1e6, "cm³"), (0.0, 1e9, "mm³")),
        "Pa": ((1e6, 1e-6, "MPa"), (2e3, 1e-3, "kPa"), (0.0, 1.0, "Pa")),
    }
    if top > 0 and units in steps:
        _, factor, name = next(step for step in steps[units] if top > step[0])
        return Scale(factor, 0.0, name)
    if units in ENERGIES and 5e-8 < top < 2e9:
        _, factor, prefix = next(step for step in ((2e6, 1e-6, "M"), (2e3, 1e-3, "k"), (0.05, 1.0, ""), (5e-5, 1e3, "m"), (0.0, 1e6, "µ")) if top > step[0])
        return Scale(factor, 0.0, prefix + units_text(units))
    return Scale(units=units_text(units))


def is_temperature(name: str) -> bool:
    """Whether a variable is an absolute temperature, which figures show in degrees Celsius."""
    return re.match(r"(measured_)?temperature", name) is not None


def is_temperature_path(path: str) -> bool:
    """Whether a config path names an absolute temperature."""
    return path.rsplit(".", 1)[-1] in _TEMPERATURES


def number(value: Any, digits: int = 3) -> str:
    """Some significant digits, without an exponent where that reads well; text as it is, shortened."""
    if isinstance(value, str):
        value = visible(value)
        return value if len(value) <= 28 else value[:27] + "…"
    value = float(value)
    if math.isnan(value):
        return "nan"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0:
        return "0"
    magnitude = math.floor(math.log10(abs(value)))
    if -3 <= magnitude < 6:
        places = digits - 1 - magnitude
        text = f"{round(value, places):.{max(0, places)}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
    else:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".")
        text = ("" if mantissa == "1" else f"{mantissa}·") + "10" + str(int(exponent)).translate(_RAISED)
    return text.replace("-", "−")


def numbers(values: Iterable[Any]) -> list[str]:
    """Each value in words, in as many digits as tell apart those that differ; long texts by their number where their beginnings are the same."""
    values = list(values)
    for digits in (3, 4, 5, 6, 8, 10, 12, 15, 0):
        texts = [number(value, digits) if digits or isinstance(value, str) else repr(float(value)).replace("-", "−") for value in values]
        if len(set(texts)) == len(set(values)):
            return texts
    return [f"{text} ({place + 1})" if texts.count(text) > 1 else text for place, text in enumerate(texts)]


def symbol(name: str) -> str:
    """The letter of a parameter, from its short name or its path; empty where it has none."""
    word = name.rsplit(".", 1)[-1]
    return SYMBOLS.get(word, word if re.fullmatch(r"[A-Za-z]\d?", word) else "")  # M or k0, but no zz


def called(name: str) -> str:
    """The letter of a parameter, behind whose it is where its name says so (`pan convection β`); else its name as words."""
    *whose, last = name.rsplit(".", 1)[-1].split("_")
    return symbol(name) or " ".join([*whose, SYMBOLS.get(last, last)])


def short(long_name: str) -> str:
    """A long name without its afterthoughts: up to the first semicolon, colon or bracket, and without what it was weighted with or averaged over."""
    return re.sub(r", (weighted|mean since) [^,]*", "", re.split(r"[;:(]", long_name)[0]).strip()


def title_case(text: str) -> str:
    """The first letter large, unless it is a symbol of its own (`x of the material`)."""
    return text[:1].upper() + text[1:] if len(text.split(" ", maxsplit=1)[0]) > 1 else text


def with_units(text: str, units: str) -> str:
    """`text [units]`."""
    return f"{text} [{units}]" if units else text


def wrapped(text: str, width: int) -> str:
    """A label in lines of about `width` letters, no more than it needs, and these about as long as one another."""
    lines = broken(text, width)
    return "\n".join(next(narrow for less in range(1, width + 1) if len(narrow := broken(text, less)) == len(lines)))


def broken(text: str, width: int) -> list[str]:
    """Lines of a text, each as full as `width` letters allow."""
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def reason(status: str, error: str) -> str:
    """Why a point has no number, without what differs from point to point: `diverged: det F <= 0`."""
    text = visible(re.split(r"\s+at particle|\s+at node|,? at t\s*=|, t\s*=|, step \d|\n", error.strip())[0].strip(" ,;"))
    text = text.replace("<=", "≤").replace(">=", "≥")
    if not text:
        return status
    if not text.startswith(status):
        text = f"{status}: {text}"
    return text if len(text) <= 72 else text[:71] + "…"


def counted(count: int, one: str) -> str:
    """`1 point`, `3 points`."""
    return f"{count} {one}" if count == 1 else f"{count} {one}s"


def compose(name: str, long_name: str, units: str, mark: Callable[[str], str] = symbol) -> str:
    """An axis label of a parameter: `Heat conductivity κ [W/m/K]`."""
    letter, text = mark(name), short(long_name) or name.replace("_", " ")
    if letter and text != letter and not text.endswith(f" {letter}"):
        text = f"{text} {letter}"
    return with_units(title_case(text), units)
