"""mpm compare: same or not."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Json
from mpm_cli.talk import document, say

PLACE = "Dataset file, or the folder that holds it."
One = Annotated[Path, typer.Argument(metavar="A", help=PLACE, show_default=False)]
Other = Annotated[Path, typer.Argument(metavar="B", help=PLACE, show_default=False)]


def compare(
    a: One,
    b: Other,
    rtol: Annotated[float, typer.Option(min=0, help="Relative tolerance.")] = 0.0,
    atol: Annotated[float, typer.Option(min=0, help="Absolute tolerance.")] = 0.0,
    as_json: Json = False,
) -> None:
    """Compare the results of two datasets.

    Wall times, attempts and provenance are ignored. Exit codes: 0 the same; 1 different.
    """
    from mpm.sweep.compare import compare as differences

    found = differences(a, b, rtol, atol)
    if as_json:
        document({"same": not found, "differences": found})
    else:
        say("\n".join(found) or "same")
    raise typer.Exit(int(bool(found)))
