"""mpm plot: figures of a dataset."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder, folder
from mpm_cli.talk import say


def plot(
    out: Folder,
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME...]", help="Figures to draw: overview, series, finals, snapshot.  [default: overview]", show_default=False),
    ] = None,
    path: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", parser=folder, help="File for the figure, if there is only one.", show_default=False)
    ] = None,
    svg: Annotated[bool, typer.Option("--svg", help="Write OUT/<name>.svg instead of .png.")] = False,
) -> None:
    """Draw figures of a sweep as PNG or SVG."""
    from mpm.plots import figures

    for written in figures(out, names or None, path, svg):
        say(str(written))
