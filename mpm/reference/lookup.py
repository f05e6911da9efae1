"""All entries, those that a word means, and the nearest ones."""

import difflib
import re
from dataclasses import replace

from mpm.reference import keys, results, sections
from mpm.reference.entry import Entry
from mpm.reference.results import VARIABLE

MOST_SHOWN = 12  # entries shown at once


def every(commands: list[Entry]) -> list[Entry]:
    """All there are; the commands come from the command line, which lies above."""
    found = [*results.statuses(), *results.outcomes(), *results.warnings(), *results.exit_codes()]
    return [*found, *commands, *sections.entries(), *keys.entries(), *results.observables(), *results.sides()]


def find(word: str, entries: list[Entry]) -> list[Entry]:
    """Entries of exactly this word; else of keys and kinds whose path ends so, the shortest path first; else of names that hold probes and walls."""
    word = word.strip().strip("`")
    asked = without_names(word)
    if exact := [one for one in entries if word.lower() in (one.word.lower(), one.facts.get("asked as", "").lower())]:
        tails = [one for one in entries if one not in exact and tail(one.word, asked)]
        return exact + tails
    if flags := [one for one in entries if word.lstrip("-") in (name.lstrip("-") for name in one.facts.get("names", "").split())]:
        return flags
    if tails := [one for one in entries if tail(one.word, asked)]:
        return sorted(tails, key=lambda one: one.word.count("."))
    if named := [one for one in entries if one.what == VARIABLE and "<" in one.word and re.fullmatch(pattern(one.word), word.replace(".", "_"))]:
        return named[:1]
    return [one for one in entries if word in re.split(r"[,;] (?:or )?", one.facts.get("allowed", ""))]


def grouped(entries: list[Entry]) -> list[Entry]:
    """Entries that say the same at several places as one, which names the others."""
    same: dict[tuple, list[Entry]] = {}
    for one in entries:
        same.setdefault((one.word.rpartition(".")[2], one.text, one.facts.get("unit")), []).append(one)
    return [replace(first, facts=first.facts | {"also at": ", ".join(one.word for one in rest)}) for first, *rest in same.values()]


def tail(path: str, word: str) -> bool:
    """Whether a path of a key ends with a word, names of bodies and materials left out."""
    plain = without_names(path)
    return plain == word or plain.endswith(f".{word}")


def without_names(path: str) -> str:
    """`materials.<name>.heat` and `materials.dough.heat` as one: what a config's owner chose is left out."""
    path = re.sub(r"\.(?:<name>|<n>|\d+)", "", path)
    return re.sub(
        r"^(materials|bodies|tools|output\.probes|output\.measured)\.(?!shape|material|density|elastic|flow|heat|expansion|heating)\w+(?=\.)", r"\1", path
    )


def pattern(word: str) -> str:
    """`time_to.<probe>.<value>_degC` as what matches names of a dataset."""
    parts = re.split(r"<[^>]+>", word.replace(".", "_"))
    return r"\w+?".join(map(re.escape, parts))


def nearest(word: str, entries: list[Entry]) -> list[str]:
    """Words like this one: whole ones, last words of paths, and those whose meaning holds it."""
    names = {name.lower(): name for one in entries for name in (one.word, one.word.rpartition(".")[2]) if "<" not in name}
    close = [names[found] for found in difflib.get_close_matches(word.lower(), names, 6, 0.6)]
    told = [one.word for one in entries if word.lower() in one.text.lower()][:6] if len(word) > 2 else []
    return list(dict.fromkeys([*close, *told]))
