"""mpm explain: what a word means."""

from typing import Annotated

import typer
from mpm_cli.options import Json
from mpm_cli.talk import document, say, warn

WORD = "A key (kappa, method.transfer), a kind, an outcome, a status, a warning, an exit code, a variable of a dataset, a side, a command or a flag."
Word = Annotated[list[str], typer.Argument(metavar="WORD...", help=WORD, show_default=False)]


def explain(word: Word, as_json: Json = False) -> None:
    """Print what a word means.

    The entries are those of the reference pages of the docs. An unknown word is answered with the nearest ones.
    Exit codes: 0 found; 2 not found.
    """
    from dataclasses import asdict

    from mpm_cli.listing import commands

    from mpm.reference.lookup import MOST_SHOWN, every, find, grouped, nearest

    asked = " ".join(word)
    entries = every(commands())
    found = grouped(find(asked, entries))
    if not found:
        near = nearest(asked, entries)
        warn(f"nothing is called {asked!r}; near: {', '.join(near)}" if near else f"nothing is called {asked!r}; `mpm docs` names the pages")
        raise typer.Exit(2)
    if as_json:
        document([asdict(one) for one in found])
        return
    say("\n\n".join(one.said() for one in found[:MOST_SHOWN]))
    if len(found) > MOST_SHOWN:
        say(f"\nand {len(found) - MOST_SHOWN} more: " + ", ".join(one.word for one in found[MOST_SHOWN:]))
