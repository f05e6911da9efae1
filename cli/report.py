"""mpm report: one HTML page of a sweep."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder, Json, Quiet, folder
from mpm_cli.talk import document, say, warn

TO = "File for the page.  [default: OUT/report.html]"


@contextlib.contextmanager
def without(what: str) -> Iterator[None]:
    """What the results hold nothing for is left out, with a word: the page is worth having without it."""
    from mpm.exports import ExportError
    from mpm.movies import MovieError
    from mpm.opened import UnknownPoint

    try:
        yield
    except (ExportError, MovieError, UnknownPoint) as error:
        warn(f"no {what}: {error}")


def report(
    out: Folder,
    to: Annotated[Path | None, typer.Option("-o", "--out", "--to", metavar="FILE", parser=folder, help=TO, show_default=False)] = None,
    with_movie: Annotated[bool, typer.Option("--movie", help="Also make OUT/movie.webp if there are snapshots; it goes into the page if it is small.")] = False,
    with_paraview: Annotated[bool, typer.Option("--paraview", help="Also make OUT/paraview.vtkhdf if there are snapshots.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write one HTML page of a sweep or a run that can be sent to anyone.

    It holds the question, figures with their tables, what failed and why, costs and provenance, and needs no network and no other file. Of a fit, a
    sensitivity analysis, a stability map or a chart in the folder the answer comes first.
    """
    from mpm.reports import report as write

    also: list[Path] = []
    if with_movie:
        from mpm_cli.progress import counter

        from mpm.movies import movie

        with without("movie"), counter("frames", as_json, quiet) as told:
            also.append(movie(out, told=told))
    if with_paraview:
        from mpm.exports import export
        from mpm.plots import dataset_of

        with without("file for ParaView"):
            also += export(out, to=dataset_of(out).with_name("paraview.vtkhdf"))
    written = write(out, to)
    if as_json:
        document({"file": written, "also": also})
    else:
        for path in (*also, written):
            say(str(path), quiet=quiet)
