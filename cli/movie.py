"""mpm movie: snapshots as a moving picture."""

import re
from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder, Json, Points, Quiet, folder
from mpm_cli.talk import document, say


def pixels(text: str) -> tuple[int, int]:
    """`600x400`."""
    match = re.fullmatch(r"\s*(\d{2,4})\s*[x×]\s*(\d{2,4})\s*", text)
    if match is None:
        raise typer.BadParameter(f"{text!r} is no size; say 600x400")
    return int(match[1]), int(match[2])


OF = "Field that colours tell.  [default: the first that differs from place to place or in time]"
SPEED = "Seconds of the run per second of the movie.  [default: a few seconds in all]"
Size = Annotated[tuple, typer.Option("--size", metavar="WxH", parser=pixels, help="Size in pixels.  [default: 600x400]", show_default=False)]


def movie(
    out: Folder,
    points: Points = None,
    to: Annotated[
        Path | None,
        typer.Option("-o", "--out", "--to", metavar="FILE", parser=folder, help="File: .webp, .gif or .mp4.  [default: OUT/movie.webp]", show_default=False),
    ] = None,
    of: Annotated[str | None, typer.Option("--of", metavar="FIELD", help=OF, show_default=False)] = None,
    every: Annotated[int, typer.Option("--every", metavar="N", min=1, help="Show one of N snapshots.")] = 1,
    speed: Annotated[float | None, typer.Option("--speed", metavar="S", min=0, help=SPEED, show_default=False)] = None,
    size: Size = "600x400",  # type: ignore[assignment]  # a default goes through the parser too
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Make a movie of snapshots. Several points are shown side by side, e.g. mpm movie OUT beta=all."""
    from mpm_cli.progress import counter

    from mpm.movies import movie as make

    with counter("frames", as_json, quiet) as told:
        written = make(out, points or (), to, of, every, speed or None, size, told)
    if as_json:
        document({"file": written})
    else:
        say(str(written), quiet=quiet)
