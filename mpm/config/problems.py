"""Problem: one thing that is wrong, where, and what would be right. ConfigError: all of them."""

import difflib
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from mpm.text import visible

MOST_SHOWN = 50
MOST_LISTED = 80
MOST_FINDINGS = 200  # of one kind of check; a file with more is not a config with slips
WIDTH = 120


@dataclass(frozen=True)
class Problem:
    """One error. `line` and `column` count from 1 and are 0 where there is no text, as in a dict or an override."""

    file: str
    line: int
    column: int
    path: str
    message: str
    given: str = ""
    allowed: str = ""
    suggestion: str = ""
    text: str = ""

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}" if self.line else self.file
        said = f"{place}: {self.path + ': ' if self.path else ''}{self.message}"
        if self.given:
            said += f" (given {self.given})"
        if self.allowed:
            said += f"; allowed: {self.allowed}"
        if self.suggestion:
            said += f"; did you mean {self.suggestion}?"
        said = visible(said)
        if not self.line or not self.text:
            return said
        start = max(0, self.column - WIDTH * 3 // 4)
        shown = "".join(letter if letter.isprintable() or letter == "\t" else "?" for letter in self.text[start : start + WIDTH])
        caret = "".join("\t" if letter == "\t" else " " for letter in self.text[start : self.column - 1]) + "^"
        return f"{said}\n    {shown}\n    {caret}"


class ConfigError(Exception):
    """Everything that is wrong with a config, in the order of the file."""

    def __init__(self, problems: Sequence[Problem]):
        unique = list(dict.fromkeys(problems))
        self.problems: list[Problem] = sorted(unique, key=lambda one: (one.file, one.line, one.column))
        super().__init__(str(self))

    def __str__(self) -> str:
        shown = [str(one) for one in self.problems[:MOST_SHOWN]]
        rest = len(self.problems) - MOST_SHOWN
        return "\n".join(shown + ([f"and {rest} more"] if rest > 0 else []))

    def __reduce__(self) -> tuple:
        return ConfigError, (self.problems,)


def listed(allowed: Any) -> str:
    """Allowed values as a user reads them."""
    if isinstance(allowed, str):
        return allowed
    rest = len(allowed) - MOST_LISTED
    return ", ".join(str(item) for item in list(allowed)[:MOST_LISTED]) + (f", and {rest} more" if rest > 0 else "")


def near(word: Any, allowed: Iterable[Any]) -> str:
    """The allowed word nearest to a misspelt one, or nothing."""
    if not isinstance(word, str) or len(word) > WIDTH:
        return ""
    words = {str(item): item for item in itertools.islice(allowed, MOST_FINDINGS)}
    lower = {name.lower(): name for name in words}
    found = [lower[word.lower()]] if word.lower() in lower and word not in words else difflib.get_close_matches(word, words, 1, 0.6)
    return f"'{found[0]}'" if found else ""


def brief(value: Any) -> str:
    """A given value, short and on one line."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a mapping with " + (", ".join(str(key)[:20] for key in list(value)[:4]) + (", ..." if len(value) > 4 else "") if value else "no keys")
    if isinstance(value, int) and value.bit_length() > 200:
        return "a huge whole number"
    if isinstance(value, list | tuple):
        inner = ", ".join(brief(item) for item in value[:4]) + (", ..." if len(value) > 4 else "")
        return f"[{inner}]" if len(inner) < WIDTH // 2 else f"a list of {len(value)}"
    shown = repr(value)
    return shown if len(shown) <= WIDTH // 2 else shown[: WIDTH // 2] + "...'"
