"""YAML 1.2 with places, and what a config may not hold."""

import math
import time

import numpy as np
import pytest

from mpm.config.nodes import BAD, Origin, read, scalar, wrap

TEXT = "a: 1\nb: {c: [x, 'y'], η: ~}\n"


def nodes(text):
    return read(text, Origin("f.yaml", tuple(text.splitlines())))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-4", 1e-4),
        ("-1.5E3", -1500.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("12", 12),
        ("010", 10),
        ("0o17", 15),
        ("0x1F", 31),
        ("12:30:45", "12:30:45"),
        ("yes", "yes"),
        ("no", "no"),
        ("True", True),
        ("~", None),
        ("", None),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("1_000", "1_000"),
        ("2 mm", "2 mm"),
        ("+3", 3),
        ("2026-11-22", "2026-11-22"),
        ("١٢", "١٢"),
    ],
)
def test_scalars_of_yaml_1_2(text, value):
    found = scalar(text)
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize("text", [".nan", "1e999", "9" * 31])
def test_numbers_that_are_refused(text):
    with pytest.raises(ValueError, match=r"NaN|too large|digits"):
        scalar(text)


def test_places():
    root, problems = nodes(TEXT)
    assert not problems and root.plain() == {"a": 1, "b": {"c": ["x", "y"], "η": None}}
    assert root.keys["b"][1:] == (2, 1)
    inner = root.child("b")
    assert (inner.line, inner.column) == (2, 4) and inner.keys["η"][1:] == (2, 18)
    assert [(item.line, item.column) for item in inner.child("c").value] == [(2, 9), (2, 12)]
    assert inner.child("d") is None and inner.child("c").child(2) is None


def test_all_problems_of_one_text():
    root, problems = nodes("a: &x 1\nb: *x\nc: !!int 3\nd: 1\nd: 2\ne: .nan\n? [1]\n: 2\n")
    assert [(one.line, one.column, one.path) for one in problems] == [(1, 4, "a"), (2, 4, "b"), (3, 4, "c"), (5, 1, ""), (6, 4, "e"), (7, 3, "")]
    assert root.plain()["d"] == 1 and root.plain()["b"] is BAD


@pytest.mark.parametrize(
    "text",
    [
        "[" * 500_000,
        "{a: " * 200_000,
        "- " * 400_000,
        "? " * 400_000,
        "a: [" + "[],".join("[" for _ in range(5000)),
        "x\x07",
        "%YAML 9.9\n---\na",
        "a: &a &b 1",
        "&a [*a]",
        "'" * 999_999,
        "\ufeff",
        "a: |\n x\n\x85",
        "--- ---",
        "!<tag> x",
        "a: !",
        "*",
        "&",
        ": :",
        "\t- a",
        "a:\n\t- b",
        "{" * 19,
    ],
)
def test_hostile_text_is_refused_fast_or_harmless(text):
    start = time.process_time()
    root, problems = nodes(text)
    assert time.process_time() - start < 2
    assert problems or root is None or root.plain() is not None or root.value is None


def test_python_data():
    problems = []
    root = wrap({"a": np.float64(1.5), "b": np.arange(3), "c": (1, "x", None, True)}, Origin("<dict>"), problems)
    assert root.plain() == {"a": 1.5, "b": [0, 1, 2], "c": [1, "x", None, True]} and not problems
    circle = {}
    circle["a"] = circle
    for data, message in (({1: 2}, "a key must be text"), ({"a": object()}, "a object cannot stand"), (circle, "more than 20 levels")):
        problems = []
        wrap(data, Origin("<dict>"), problems)
        assert len(problems) == 1 and message in problems[0].message and problems[0].line == 0
