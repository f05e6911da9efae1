"""The reference pages of the docs, as Markdown: config, dataset, commands, Python, and one page a shipped scene."""

import importlib
import inspect
from collections.abc import Iterable

import mpm
from mpm.reference import keys, results
from mpm.reference.entry import Entry
from mpm.starting.places import folder
from mpm.starting.scenes import Scene, command, copy, scenes

MADE = "This page is made from what the program itself uses; `mpm explain WORD` prints any of its entries."

GROUPS = """\
A sweep is one file, `OUT/sweep.nc`, and a run `OUT/run.nc`, both NetCDF-4. `xr.open_dataset(file)` reads the first group, `xr.open_datatree(file)` all of them.

| group | holds | dimensions |
|---|---|---|
| `/` | one number a point | what is swept |
| `/series` | observables over time | what is swept, `time` |
| `/grid` | fields on the grid | what is swept, `snapshot`, then coordinates |
| `/particles` | fields of particles, one after another | `obs` |

Particles of a snapshot lie in rows `row_start` to `row_start + row_size`; `mpm.particles(tree, snapshot=1.0, kappa=0.35)` gives them as a table.

Totals (J, kg, N, m2, ...) are of the whole body in axisymmetric and three-dimensional scenes, of a metre of depth in the plane, of a square metre in one
dimension, of a cubic metre at a material point.
"""


def pages(commands: list[Entry]) -> dict[str, str]:
    """All pages by file name without its end."""
    found = {"reference_config": config(), "reference_dataset": dataset(), "reference_commands": command_page(commands), "reference_python": python()}
    return found | {f"scene_{name}": scene_page(scene) for name, scene in scenes().items()}


def table(entries: Iterable[Entry], word: str, *names: str) -> str:
    """A Markdown table of entries."""
    rows = [one.cells(*names) for one in entries]
    titles = [word, *("meaning" if name == "text" else name for name in names)]
    return "\n".join([f"| {' | '.join(titles)} |", "|" + "---|" * len(titles), *rows, ""])


def config() -> str:
    """Every section with its keys and kinds: a heading a mapping, a row a key."""
    groups: dict[str, list[Entry]] = {}
    kinds: dict[str, Entry] = {}
    for one in keys.entries():
        parent, _, name = one.word.rpartition(".")
        if one.what.endswith("a kind"):
            kinds[one.word] = one
        else:
            groups.setdefault(parent, []).append(Entry(name, one.what, one.text, one.facts))
    lines = [
        "# Config reference",
        "",
        MADE,
        "",
        "`<name>` stands for a name that you choose, `<n>` for the number of an entry of a list, which begins at 0.",
        "",
    ]
    lines += ["## Sections", "", table(groups.pop(""), "section", "text", "default", "example")]
    top = ""
    for parent in dict.fromkeys([*groups, *kinds]):
        if parent.split(".")[0] != top:
            top = parent.split(".")[0]
            lines += [f"## `{top}`", ""]
        if parent != top:
            lines += [f"### `{parent}`", ""]
        if parent in kinds:
            lines += [f"{kinds[parent].what.removesuffix(', a kind')}: {kinds[parent].text} Written {kinds[parent].facts['written']}.", ""]
        if parent in groups:
            lines += [table(groups[parent], "key", "text", "unit", "allowed", "default", "example")]
    return "\n".join(lines)


def dataset() -> str:
    """Groups, variables, statuses, outcomes, warnings, exit codes, sides."""
    lines = ["# Dataset reference", "", MADE, "", GROUPS]
    variables = results.observables()
    for group in results.GROUPS.values():
        rows = [one for one in variables if one.facts["group"] == group]
        lines += [f"## Variables of {group}", "", table(rows, "variable", "text", "unit", "symbol", "asked as")]
    tables: tuple[tuple[str, list[Entry], tuple[str, ...]], ...] = (
        ("Status of a point", results.statuses(), ("text",)),
        ("Outcomes", results.outcomes(), ("text", "advice")),
        ("Warnings", results.warnings(), ("flag", "advice")),
        ("Exit codes", results.exit_codes(), ("text",)),
        ("Sides of bodies, walls of the domain", results.sides(), ("text", "surfaces", "walls")),
    )
    for title, entries, names in tables:
        lines += [f"## {title}", "", table(entries, "word", *names)]
    return "\n".join([*lines, "Causes and cures: [trouble](trouble.md).", ""])


def command_page(commands: list[Entry]) -> str:
    """Every command with its flags."""
    lines = ["# Command reference", "", MADE, ""]
    flags: list[Entry] = []
    for one in [*commands, None]:
        if one is None or one.what == "command":
            lines += [table(flags, "flag", "text")] if flags else []
            flags = []
        if one is None:
            break
        if one.what == "command":
            lines += [f"## `{one.word}`", "", f"```text\n{one.facts['usage']}\n```", "", one.text, "", one.more, ""]
        else:
            flags.append(Entry(one.word.split(" ", 2)[2], one.what, one.text))
    return "\n".join(lines)


def python() -> str:
    """The public names of `mpm` with signatures and docstrings."""
    lines = ["# Python reference", "", "The same as the shell, by the same code. How to use it: [Python](python.md).", ""]
    for name in mpm.__all__:
        thing = getattr(mpm, name)
        if inspect.ismodule(thing):
            lines += [f"## `mpm.{name}`", "", "```text", inspect.getdoc(importlib.import_module(f"mpm.{name}")) or "", "```", ""]
            continue
        signature = str(inspect.signature(thing)) if inspect.isroutine(thing) else ""
        lines += [f"## `mpm.{name}`", "", "```text", f"{name}{signature}", "", inspect.getdoc(thing) or "", "```", ""]
    return "\n".join(lines)


def scene_page(scene: Scene) -> str:
    """A scene as a page of the cookbook: what for, what to trust, picture, config, command."""
    texts = copy(scene)
    lines = [f"# {scene.title}", "", scene.purpose, ""]
    if (folder("docs") / "gallery" / f"{scene.name}.png").is_file():
        lines += [f"![{scene.title}](gallery/{scene.name}.png)", ""]
    lines += ["```text", f"mpm new {scene.name}", f"mpm {command(texts[scene.file.name])} {scene.file.name}", "```", ""]
    lines += [f"**What to trust.** {scene.trust}", ""] if scene.trust else []
    lines += [
        f"**Cost.** {scene.cost}",
        "",
        f"**Source.** {scene.source}",
        "",
        "**The config.**",
        "",
        "```yaml",
        uncommented(texts[scene.file.name]),
        "```",
        "",
    ]
    return "\n".join(lines)


def uncommented(text: str) -> str:
    """A config without the comments that it opens with, which stand above it on the page."""
    return "\n".join(line for line in text.rstrip().splitlines() if not line.startswith("#"))
