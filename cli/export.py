"""mpm export: results in the files of other programs."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder, Json, Points, Quiet, folder
from mpm_cli.talk import document, say

TO = "File to write; its suffix says the format: .vtkhdf (ParaView, with time), .usd, .csv, .parquet, .zarr.  [default: OUT/run.vtkhdf or OUT/sweep.vtkhdf]"


def export(
    out: Folder,
    points: Points = None,
    to: Annotated[Path | None, typer.Option("--to", "-o", "--out", metavar="FILE", parser=folder, help=TO, show_default=False)] = None,
    long: Annotated[bool, typer.Option("--long", help="Tables: a row for each number, series too, rather than a row for each point.")] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write results as other programs read them.

    Snapshots over time go to ParaView (.vtkhdf) or to Houdini, Blender and Omniverse (.usd); tables of a sweep to CSV and Parquet; the whole dataset to Zarr.
    Several points are several files.
    """
    from mpm.exports import export as write

    written = write(out, points or (), to, long)
    if as_json:
        document({"files": written})
    else:
        for path in written:
            say(str(path), quiet=quiet)
