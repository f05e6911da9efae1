"""A plain scalar of YAML to a value of Python, by the core schema of YAML 1.2."""

import math
import re
from typing import Any

MOST_DIGITS = 30
INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
WORDS = {"": None, "~": None, **dict.fromkeys(("null", "Null", "NULL")), **dict.fromkeys(("true", "True", "TRUE"), True),
         **dict.fromkeys(("false", "False", "FALSE"), False)}  # fmt: skip
INFINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)")
NAN = (".nan", ".NaN", ".NAN")


def scalar(text: str) -> Any:
    """A plain scalar by the core schema of YAML 1.2: null, true, 12, 0x1F, 1e-4, .inf, or text. ValueError says what a config may not hold."""
    if text in WORDS:
        return WORDS[text]
    if INT.fullmatch(text):
        if len(text) > MOST_DIGITS:
            raise ValueError(f"a whole number with {len(text)} digits")
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    if FLOAT.fullmatch(text):
        if math.isinf(number := float(text)):
            raise ValueError("a number too large for floating point")
        return number
    if found := INFINITE.fullmatch(text):
        return -math.inf if found[1] == "-" else math.inf
    if text in NAN:
        raise ValueError("not a number (NaN)")
    return text
