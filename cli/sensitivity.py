"""mpm sensitivity: which parameter moves what, from a finished sweep, failed points and all."""

from pathlib import Path
from typing import Annotated, Any

import typer
from mpm_cli.options import Folder, Json, Quiet, folder
from mpm_cli.talk import document, internal, say

OF = "Observable to analyse; repeat for more.  [default: those that the config lists]"
SURROGATE = "Fit a surrogate through the sample and take first and total indices from it."


def sensitivity(
    out: Folder,
    of: Annotated[list[str] | None, typer.Option("--of", metavar="NAME", help=OF, show_default=False)] = None,
    surrogate: Annotated[bool, typer.Option("--surrogate", help=SURROGATE)] = False,
    to: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", parser=folder, help="Dataset to write.  [default: OUT/sensitivity.nc]", show_default=False)
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Tell which parameter moves which observable, with intervals, and which ranges fail.

    Works on any finished sweep. Failed points are left out and told; where failing depends on a parameter, intervals cover what they may be. A time that was
    not reached counts as at least the end. Writes OUT/sensitivity.nc and .png. Saltelli designs need SALib: pip install 'mpm[sensitivity]'.
    Exit codes: 0 ok; 2 usage.
    """
    from mpm.sensitivity.api import analyse, opened, sentences, write

    found = analyse(opened(out), tuple(of or ()), surrogate)
    dataset = write(found, to or (out if out.is_dir() else out.parent) / "sensitivity.nc")
    picture, said = draw(dataset), sentences(found)
    if as_json:
        document({"dataset": dataset, "picture": picture, "points": len(found.sample.ok), "share_failed": found.share, "sentences": said,
                  "failing": [vars(row) for row in found.failed], "observables": [observable(one, found) for one in found.effects]})  # fmt: skip
        return
    for line in (*said, str(dataset), *([str(picture)] if picture else [])):
        say(line, quiet=quiet)


def observable(one: Any, found: Any) -> dict[str, Any]:
    """One observable of the JSON document: (value, lower, upper) by parameter."""
    names = [parameter.name for parameter in found.sample.parameters]
    by = lambda rows: None if rows is None else dict(zip(names, rows, strict=True))  # noqa: E731
    return {"name": one.name, "how": one.how, "points": one.known, "not_reached": one.late, "spearman": by(one.spearman), "first": by(one.first),
            "total": by(one.total)}  # fmt: skip


def draw(dataset: Path) -> Path | None:
    """OUT/sensitivity.png."""
    import xarray

    from mpm.plots.sensitivity import draw as figure
    from mpm.plots.style import save

    try:
        return save(figure(xarray.load_dataset(dataset, engine="h5netcdf")), dataset.with_suffix(".png"))
    except Exception as error:  # the indices are there and sound; a figure that fails is told, and does not hide them
        internal(error, "the figure failed")
        return None
