"""mpm docs: where the docs and the scenes are, and a page of them."""

from typing import Annotated

import typer
from mpm_cli.options import Json
from mpm_cli.talk import document, say

Page = Annotated[str | None, typer.Argument(metavar="PAGE", help="Name of a page to print, as Markdown.", show_default=False)]


def docs(page: Page = None, as_json: Json = False) -> None:
    """Print where the docs and the scenes are, or one page of the docs.

    `mpm docs tutorial | less` reads a page; `mpm explain WORD` looks up a key, a result or a message.
    """
    from mpm.starting.places import folder

    files = {file.stem: file for file in sorted(folder("docs").glob("*.md"))}
    if page is not None:
        if page.removesuffix(".md") not in files:
            raise typer.BadParameter(f"there is no page {page!r}; pages: {', '.join(files)}")
        say(files[page.removesuffix(".md")].read_text(encoding="utf-8").rstrip())
        return
    titles = {name: title(file.read_text(encoding="utf-8")) for name, file in files.items()}
    places = {"docs": folder("docs"), "scenes": folder("configs") / "scenes", "schema": folder("configs") / "schema.json"}
    if as_json:
        document({**places, "pages": titles})
        return
    say("\n".join([f"{name:<8} {place}" for name, place in places.items()]))
    say("\n".join(["pages (mpm docs PAGE prints one):", *(f"  {name:<14} {title}" for name, title in titles.items())]))
    say("a word of a config, a result or a message: mpm explain WORD; a scene to begin from: mpm new")


def title(text: str) -> str:
    """The first heading of a page."""
    return next(line.strip("# ") for line in text.splitlines() if line.startswith("#"))
