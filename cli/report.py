"""mpm report: one HTML page of a sweep."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder, Json, Quiet, folder
from mpm_cli.talk import document, say

TO = "File for the page.  [default: OUT/report.html]"


def report(
    out: Folder,
    to: Annotated[Path | None, typer.Option("-o", "--out", "--to", metavar="FILE", parser=folder, help=TO, show_default=False)] = None,
    with_movie: Annotated[bool, typer.Option("--movie", help="Also make OUT/movie.webp; it goes into the page if it is small.")] = False,
    with_paraview: Annotated[bool, typer.Option("--paraview", help="Also make OUT/paraview.vtkhdf.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write one HTML page of a sweep or a run that can be sent to anyone.

    It holds the question, figures with their tables, what failed and why, costs and provenance, and needs no network and no other file. Of a fit, a
    sensitivity analysis, a stability map or a chart in the folder the answer comes first.
    """
    from mpm.reports import report as write

    also = []
    if with_movie:
        from mpm_cli.progress import counter

        from mpm.movies import movie

        with counter("frames", as_json, quiet) as told:
            also.append(movie(out, told=told))
    if with_paraview:
        from mpm.exports import export
        from mpm.plots import dataset_of

        also += export(out, to=dataset_of(out).with_name("paraview.vtkhdf"))
    written = write(out, to)
    if as_json:
        document({"file": written, "also": also})
    else:
        for path in (*also, written):
            say(str(path), quiet=quiet)
