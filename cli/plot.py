"""mpm plot: figures of a dataset."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import POINT, Folder, folder
from mpm_cli.talk import say

FIGURE = "File for the figure, if there is only one."
OF = "finals: the final to draw. snapshot: the field that colours tell."
OVER = "finals: the swept parameter along the figure."
AT = "snapshot: times to show [s], e.g. 5,10."


def times(text: str) -> list[float]:
    """`5,10` as numbers."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{text!r} are no times; say seconds, as 5,10") from None


def plot(
    out: Folder,
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME...]", help="Figures to draw: overview, series, finals, snapshot.  [default: overview]", show_default=False),
    ] = None,
    path: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", parser=folder, help=FIGURE, show_default=False)] = None,
    svg: Annotated[bool, typer.Option("--svg", help="Write OUT/<name>.svg instead of .png.")] = False,
    of: Annotated[str | None, typer.Option("--of", metavar="NAME", help=OF, show_default=False)] = None,
    over: Annotated[str | None, typer.Option("--over", metavar="NAME", help=OVER, show_default=False)] = None,
    point: Annotated[list[str] | None, typer.Option("--point", metavar="POINT", help=f"snapshot: {POINT}", show_default=False)] = None,
    at: Annotated[list | None, typer.Option("--at", metavar="T,T", parser=times, help=AT, show_default=False)] = None,
) -> None:
    """Draw figures of a sweep or a run as PNG or SVG.

    For example: mpm plot OUT finals --of extent_x --over eta; mpm plot OUT snapshot --of stress_mises --at 1,5.
    """
    from mpm.plots import KINDS, UnknownFigure, figures

    names, there = names or ["overview"], (*KINDS, "snapshot")
    if unknown := [name for name in names if name not in there]:
        raise UnknownFigure(f"there is no figure {unknown[0]!r}; there are {', '.join(there)}")
    if path is not None and len(names) > 1:
        raise UnknownFigure(f"one file cannot hold {len(names)} figures; leave the file out, or name one figure")
    others = [name for name in names if name != "snapshot"]
    if others:
        more = {"over": over} | ({"of": of} if "snapshot" not in names else {})
        for written in figures(out, others, path, svg, **{name: value for name, value in more.items() if value is not None}):
            say(str(written))
    if "snapshot" in names:
        from mpm.movies import still
        from mpm.plots import dataset_of

        target = path or dataset_of(out).parent / f"snapshot{'.svg' if svg else '.png'}"
        still(out, point or (), target, of, [when for part in at or () for when in (part if isinstance(part, list) else [part])])
        say(str(target))
