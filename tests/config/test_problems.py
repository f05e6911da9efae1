"""How problems are written."""

from mpm.config.problems import MOST_LISTED, MOST_SHOWN, ConfigError, Problem, brief, listed, near


def test_one_line_source_and_caret():
    one = Problem("a.yaml", 3, 8, "time.end", "the time is out of range", "-1", "a number above 0 [s]", "1", "\ttime: {end: -1}\x1b[31m")
    assert str(one) == (
        "a.yaml:3:8: time.end: the time is out of range (given -1); allowed: a number above 0 [s]; did you mean 1?\n    \ttime: {end: -1}?[31m\n    \t      ^"
    )
    assert str(Problem("--set a=1", 0, 0, "a", "wrong", text="x")) == "--set a=1: a: wrong"


def test_long_lines_are_cut_around_the_caret():
    one = Problem("a.yaml", 1, 5000, "", "wrong", text="x" * 4999 + "y" + "z" * 4999)
    shown, caret = str(one).split("\n")[1:]
    assert len(shown) < 130 and shown[caret.index("^")] == "y"


def test_order_and_repetition():
    def at(line, column):
        return Problem("a.yaml", line, column, "", "wrong")

    assert ConfigError([at(9, 1), at(2, 7), at(2, 3), at(9, 1)]).problems == [at(2, 3), at(2, 7), at(9, 1)]
    many = ConfigError([at(line, 1) for line in range(1, MOST_SHOWN + 6)])
    assert str(many).endswith("\nand 5 more") and len(str(many).split("\n")) == MOST_SHOWN + 1


def test_near():
    assert near("Kappa", ["kappa", "beta"]) == "'kappa'" and near("kapa", ["kappa", "alpha"]) == "'kappa'"
    assert near("xyz", ["kappa"]) == near(3, ["kappa"]) == near("kappa" * 100, ["kappa"]) == ""


def test_brief_and_listed():
    assert [brief(value) for value in (None, True, 1.5, "x", {}, {"a": 1}, [1, 2], 10**400)] == [
        "nothing", "true", "1.5", "'x'", "a mapping with no keys", "a mapping with a", "[1, 2]", "a huge whole number",
    ]  # fmt: skip
    assert len(brief("x" * 10_000)) < 100 and brief(list("a" * 100)) == "['a', 'a', 'a', 'a', ...]"
    assert listed("as it is") == "as it is" and listed(range(MOST_LISTED + 3)).endswith(f"{MOST_LISTED - 1}, and 3 more")
