"""mpm collect: the points that are there to one dataset."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.options import Folder, Json, folder
from mpm_cli.talk import document, say

ELSEWHERE = "Write the dataset to this file, or to sweep.nc in this folder: OUT itself is only read.  [default: OUT/sweep.nc]"
Target = Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", parser=folder, help=ELSEWHERE, show_default=False)]


def collect(out: Folder, target: Target = None, as_json: Json = False) -> None:
    """Assemble OUT/sweep.nc from the finished points.

    This works while the sweep is running, too: points that have not run have the status `pending`.
    """
    from mpm.sweep.api import collect_folder

    if target is not None and (target.is_dir() or not target.suffix):
        target.mkdir(parents=True, exist_ok=True)
        target = target / "sweep.nc"
    path, written, found = collect_folder(out, target)
    if as_json:
        document({"dataset": path, "written": written, "counts": found})
    else:
        say(", ".join(f"{count} {name}" for name, count in found.items() if count))
        say(f"{path}{'' if written else ' (up to date)'}")
