"""mpm plot: a figure of a dataset."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder
from mpm_cli.talk import say


def plot(
    out: Folder,
    name: Annotated[str | None, typer.Argument(help="Which figure.  [default: the overview]", show_default=False)] = None,
    path: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="PNG or SVG.  [default: OUT/<name>.png]", show_default=False)] = None,
) -> None:
    """Draw a figure of a sweep as PNG or SVG."""
    from mpm.plots import figures

    target = path or out / f"{name or 'overview'}.png"
    figures(out, name, target)
    say(str(target))
