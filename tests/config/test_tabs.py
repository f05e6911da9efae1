"""Tabs as YAML 1.2 has them (6.1 indentation, 6.2 separation, 6.3 lines): the values that libyaml and the specification give."""

import pytest

from mpm.config.nodes import Origin, lines, read


def tried(text):
    node, problems = read(text, Origin("x.yaml", lines(text)))
    return node.plain() if node is not None and not problems else problems


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a:\t1", {"a": 1}),
        ("a: 1\t", {"a": 1}),
        ("a: 1 \t# note", {"a": 1}),
        ("a\t:\t{b:\t1,\tc: 2\t}", {"a": {"b": 1, "c": 2}}),
        ("a: [1,\n\t2]", {"a": [1, 2]}),
        ("[a\n\tb]", ["a b"]),
        ("a: b\tc", {"a": "b\tc"}),
        ("a: 'b\tc'", {"a": "b\tc"}),
        ("a: b\n  \tc", {"a": "b c"}),
        ("a: b\n\t\n  c", {"a": "b\nc"}),
        ("a:\n \tb", {"a": "b"}),
        ("a:\n  \t{b: 1}\nc: 2", {"a": {"b": 1}, "c": 2}),
        ("a: 1\n\t\nb: 2", {"a": 1, "b": 2}),
        ("a: 1\n\t# note\nb: 2", {"a": 1, "b": 2}),
        ("a:\t\n  - 1\n  -\t2\n", {"a": [1, 2]}),
        ("-\ta\n-\tb\n", ["a", "b"]),
        ("a: |\t\n  x\ty\n", {"a": "x\ty\n"}),
        ("a: >-\t# note\n  x\n  y\n", {"a": "x y"}),
        ("?\ta\n:\tb", {"a": "b"}),
    ],
)
def test_tabs_that_are_allowed(text, value):
    assert tried(text) == value


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [("a:\n\tb: 1", 2, 1), ("\ta: 1", 1, 1), ("a:\n\tb", 2, 1), ("-\t- a", 1, 2), ("-\ta: 1", 1, 2), ("a:\n  - b\n\t- c", 3, 1), ("a:\n  - b\n  \t- c", 3, 3)],
)
def test_a_tab_does_not_indent(text, line, column):
    (problem,) = tried(text)
    assert (problem.line, problem.column) == (line, column) and problem.message.endswith("a tab does not indent: use spaces")
