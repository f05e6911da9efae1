"""Everything that a user meets has an entry: keys, kinds, outcomes, warnings, statuses, exit codes, variables, sides, commands, flags.

`mpm explain` finds it, and the reference pages of the docs hold it.
"""

import json
import re
from pathlib import Path

import pytest
from mpm_cli.listing import commands
from mpm_cli.main import COMMANDS, main

from mpm import outcome, warned
from mpm.config.boundary import SURFACE_SIDES, WALL_SIDES
from mpm.records import variables
from mpm.reference import keys, results, sections
from mpm.reference.lookup import every, find, nearest
from mpm.reference.pages import config, dataset, pages

ROOT = Path(__file__).parents[2]
ENTRIES = every(commands())


def test_the_tables_of_the_program_are_whole():
    assert {one.word for one in results.outcomes()} == {kind for kind, _, _ in outcome.KINDS.values()} | {variables.MEMORY}
    assert [one.word for one in results.warnings()] == list(warned.KINDS)
    assert [one.word for one in results.statuses()] == list(variables.STATUS) and set(results.STATUSES) == set(variables.STATUS)
    assert {one.word for one in results.sides()} == {side for table in (SURFACE_SIDES, WALL_SIDES) for some in table.values() for side in some} | {"edge 3"}
    assert {one.word for one in results.observables()} >= set(variables.VARIABLES)


def test_exit_codes_are_those_that_commands_tell_of():
    """Every number that the help of a command gives after `Exit codes:` is in the table, and every one of the table is told by some command."""
    told = {code for one in commands() if one.what == "command" for code in re.findall(r"\b(\d+)\b(?= [a-z])", one.more.partition("Exit codes:")[2])}
    assert told - {"130", "141", "143"} <= set(results.EXIT_CODES) and {"0", "2", "3", "4", "75"} <= told
    assert set(re.findall(r"\b\d+\b", "0, 1, 2, 3, 4, 75, 130, 141, 143")) == set(results.EXIT_CODES)


def test_causes_and_cures_are_those_of_all_outcomes_warnings_statuses_and_exit_codes():
    """No heading of the page is of a word that is not there any more."""
    said = [one.word for one in sections.entries() if one.what == "cause and cure"]
    wanted = [*results.outcomes(), *results.statuses(), *results.warnings(), *results.exit_codes()]
    assert sorted(said) == sorted(one.word for one in wanted)


@pytest.mark.parametrize("what", sorted({one.what for one in ENTRIES if not one.what.startswith("status")}))
def test_every_entry_is_found_and_says_something(what):
    some = [one for one in ENTRIES if one.what == what]
    for one in some[:: 1 + len(some) // 40]:  # looking for all of them takes 4 s
        assert one in find(one.word, ENTRIES), one.word
    assert all(one.text.strip() for one in some)


def test_commands_and_flags_are_all_there():
    found = commands()
    assert [one.word for one in found if one.what == "command"] == [f"mpm {command.__name__}" for command in COMMANDS]
    assert all(one.text.strip() for one in found)


def test_the_pages_hold_every_entry():
    """The reference pages of the docs: 100 % of keys, kinds, outcomes, warnings, statuses, exit codes, variables, commands and flags."""
    made = pages(commands())
    lines, rows, heading = made["reference_config"].splitlines(), {"": []}, ""
    for line in lines:
        if line.startswith("##"):
            heading = "" if line == "## Sections" else line.strip("#` ")
            rows.setdefault(heading, [])
        elif line.startswith("| `"):
            rows[heading].append(line.split("`")[1])
    lines = set(lines)
    for one in keys.entries():
        parent, _, name = one.word.rpartition(".")
        kind = one.what.endswith("a kind")
        said = f"### `{one.word}`" if kind else name
        assert said in (lines if kind else rows[parent]), one.word
    for one in [*results.observables(), *results.statuses(), *results.outcomes(), *results.warnings(), *results.exit_codes(), *results.sides()]:
        assert f"| `{one.word}` |" in made["reference_dataset"], one.word
    for one in commands():
        said = f"## `{one.word}`" if one.what == "command" else f"| `{one.word.split(' ', 2)[2]}` |"
        assert said in made["reference_commands"], one.word
    assert len(config()) > 50_000 and len(dataset()) > 10_000


@pytest.mark.parametrize(
    "word, answer",
    [
        ("kappa", "W/m/K"),
        ("materials.dough.heat.fourier.kappa", "heat conductivity"),
        ("surfaces.0.convection.beta", "heat-transfer coefficient"),
        ("inverted", "turned inside out"),
        ("time_to_centre_95_degC", "time for centre to reach 95"),
        ("position.max_z", "largest z"),
        ("radial", "overstress that drives the flow"),
        ("observables", "dissipation.total"),
        ("75", "time budget"),
        ("Biot number", "half the thickness"),
        ("mpm sweep", "Run every missing point"),
        ("--time-budget", "Stop the sweep after this time"),
        ("lateral", "round about the axis"),
    ],
)
def test_words_of_users(word, answer, capsys):
    assert main(["explain", *word.split()]) == 0
    assert answer in capsys.readouterr().out


def test_a_word_that_is_none_is_answered_with_the_nearest(capsys):
    assert main(["explain", "kapa"]) == 2
    assert "near: kappa" in capsys.readouterr().err
    assert "inverted" in nearest("invreted", ENTRIES)
    assert main(["explain", "xqzzy"]) == 2


def test_json(capsys):
    assert main(["explain", "method.transfer", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["facts"]["default"] == "apic"


def test_shell_completion(monkeypatch, capsys):
    monkeypatch.setenv("_MPM_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "mpm sw")
    monkeypatch.setenv("COMP_CWORD", "1")
    with pytest.raises(SystemExit):
        main([])
    assert capsys.readouterr().out.split() == ["sweep"]
