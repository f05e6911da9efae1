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
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write one HTML page of a sweep or a run that can be sent to anyone.

    It holds the question, figures with their tables, what failed and why, costs and provenance, and needs no network and no other file.
    """
    from mpm.reports import report as write

    written = write(out, to)
    if as_json:
        document({"file": written})
    else:
        say(str(written), quiet=quiet)
