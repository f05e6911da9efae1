"""Plots: a dataset in, a figure out.

    overview(tree, path)           the figure that `mpm sweep` leaves beside its dataset, chosen by what the dataset holds
    figures(out, names, path)      what `mpm plot OUT [NAME...]` writes
    final(tree, of, over, ax)      one result over a swept parameter;   over_time(tree, of, ax)   series: on axes of the user's own, or on a figure of theirs
    KINDS                          names of figures: overview, series, finals

Overview    one axis or two   a final (an error, else `time_to_*`, else the first listed observable) over the longest axis, a line a value of the other;
                              beside it the probes' temperatures of a few points, coloured by swept value. A third axis makes a panel a value; further ones stay
                              at the chosen point.
            a sample          observables against each parameter, and rank correlations with bootstrap intervals
            refined           the plane of both axes, its points, and the line that was followed
            one point         its series
            no point ok       words: how many points, and why
Marks       a point that is not ok is a cross under the data, its reason in the legend; a threshold that was not reached is a triangle above it;
            a point with warnings is a ring, their kinds in the legend (of one point: under the title)
Units       as stored, but degrees Celsius for temperatures (not for differences), minutes or hours for long times, millimetres for small lengths
Measured    a measured curve lies in `/series`, beside the series that it belongs to: `measured_temperature_centre(measured_time_centre)` [K], in general
            `measured_<series>` over a time of its own [s], with `units`, `long_name` and `source`, and without swept dimensions. `/` has `misfit_centre` [K]
            for it, a number a point; the point with the least misfit is then the chosen point.
May use     xarray, matplotlib, mpm.records.variables                                    May not  see config, sweep or anything that computes
To add      a function View -> Figure in layouts.py or a sibling, and a line in `_draw`

Further files
    chart       the figure of a chart (`chart.nc`)
    fit         the figure of `mpm fit`
    outlines    walls of the domain, tools and nozzles, as lines in space
    refined     the figure of two refined axes
    sensitivity the figure of `mpm sensitivity`
    stability   the figure of `mpm stability`
    style       how figures look
    theory      the figure of `mpm.benchmarks.theory`
    view        what a dataset holds, as figures ask for it
"""

import errno
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from mpm.text import visible

KINDS = ("overview", "series", "finals")
FORMATS = (".png", ".svg", ".pdf")
DATASETS = ("sweep.nc", "run.nc")


class NoDataset(FileNotFoundError):
    """A folder without results."""


class UnknownFigure(ValueError):
    """A name that is not in KINDS, or a file that cannot hold what was asked."""


def overview(tree: Any, path: Path | str | None = None) -> Any:
    """The figure of a dataset tree, and the file `path` (PNG, SVG or PDF) where one is given. Never raises for points that failed."""
    return _finish(_draw(tree, "overview"), path)


def final(tree: Any, of: str | None = None, over: str | None = None, ax: Any = None) -> Any:
    """One result over a swept parameter, a line a value of another; the matplotlib figure.

    of      name of a result in `/`; the most interesting unless given
    over    name of a swept parameter; the longest unless given
    ax      matplotlib axes to draw on; a new figure unless given
    Raises UnknownFigure where nothing varies along an axis, for an unknown name, and where no point is ok.
    """
    from mpm.plots import finals, layouts
    from mpm.plots.style import figure, settle, styled

    view = _viewed(tree, of, over)
    if not (view.axes or view.sampled) or not view.finals:
        raise UnknownFigure("a result is drawn over the axes of a sweep; this dataset has no axis or no result")
    with styled():
        ax = figure(view.title, 5.2).add_subplot() if ax is None else ax
        x, lines, _ = layouts.arrange(view, view.finals[0])
        finals.panel(ax, view, view.finals[0], x, lines, dict(view.chosen))
        settle([ax])
    return ax.figure


def over_time(tree: Any, of: str | Iterable[str] | None = None, ax: Any = None) -> Any:
    """Series of a run, or of a few points of a sweep coloured by the swept value, with measured curves as dots; the matplotlib figure.

    of    names of series in one unit; the probes' temperatures or the first family unless given
    ax    matplotlib axes to draw on; a new figure unless given
    Raises UnknownFigure for an unknown name, and where there are no series.
    """
    from mpm.plots import layouts, series
    from mpm.plots.style import figure, settle, styled

    view = _viewed(tree)
    there = [] if view.series is None else [str(name) for name, row in view.series.data_vars.items() if "time" in row.dims]
    names = layouts.series_of(view) if of is None else [of] if isinstance(of, str) else list(of)
    if unknown := [name for name in names if name not in there]:
        raise UnknownFigure(f"there is no series {', '.join(map(repr, unknown))}; there are {', '.join(there) or 'none'}")
    if not names:
        raise UnknownFigure("the dataset holds no series")
    with styled():
        ax = figure(view.title, 4.8).add_subplot() if ax is None else ax
        series.panel(ax, view, names, layouts.along(view), dict(view.chosen))
        settle([ax])
    return ax.figure


def figures(
    out: Path | str, names: str | Iterable[str] | None = None, path: Path | str | None = None, svg: bool = False, of: str | None = None, over: str | None = None
) -> list[Path]:
    """Figures of the dataset in a folder, or of a dataset file; the paths written.

    names   of KINDS, one or several; the overview unless given
    path    the file of a single figure; else <folder>/<name>.png (.svg with `svg`)
    of      the final that `finals` and the overview draw;  over: the swept parameter along them
    Raises UnknownFigure for a name, FileNotFoundError where there is no dataset. Snapshots are drawn by mpm.movies.still.
    """
    wanted = [names or "overview"] if names is None or isinstance(names, str) else list(names) or ["overview"]
    for name in wanted:
        if name not in KINDS:
            raise UnknownFigure(f"there is no figure {name!r}; there are {', '.join(KINDS)}")
    if path is not None and len(wanted) > 1:
        raise UnknownFigure(f"one file cannot hold {len(wanted)} figures; leave the file out, or name one figure")
    if path is not None and Path(path).suffix.lower() not in FORMATS:
        raise UnknownFigure(f"{path}: a figure is written as {', '.join(FORMATS)}")
    dataset = dataset_of(Path(out))
    tree, suffix = _open(dataset), ".svg" if svg else ".png"
    targets = [place(Path(path) if path is not None else dataset.parent / f"{name}{suffix}") for name in wanted]
    for name, target in zip(wanted, targets, strict=True):
        _finish(_draw(tree, name, of, over), target)
    return targets


def dataset_of(out: Path) -> Path:
    """The dataset file of a folder: sweep.nc, else run.nc. NoDataset where there is none, or one that is not as it was written."""
    if out.is_file():
        return sound(out)
    for name in DATASETS:
        if (out / name).exists():
            return sound(out / name)
    raise NoDataset(f"{visible(str(out))} holds no {' and no '.join(DATASETS)}; give the folder that `mpm sweep` or `mpm run` wrote")


def place(path: Path) -> Path:
    """A file to write, once its folder is found to be there and to be one that can be written in."""
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "there is no such folder", str(path.parent))
    if not os.access(path.parent, os.W_OK):
        raise PermissionError(errno.EACCES, f"nothing can be written there; name another file than {path.name} with -o", str(path.parent))
    return path


def sound(path: Path) -> Path:
    """A file, if it holds results."""
    import h5py

    try:
        with h5py.File(path) as file:
            if "status" in file:
                return path
    except OSError as error:
        if error.errno:
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from None
        raise NoDataset(f"{visible(str(path))} cannot be read, so it is no dataset, or a damaged one; `mpm collect` makes that of a sweep again") from None
    raise NoDataset(f"{visible(str(path))} holds no results of `mpm sweep` or `mpm run`")


def _open(path: Path) -> Any:
    """A dataset file as a tree in memory."""
    import xarray

    with xarray.open_datatree(path, engine="h5netcdf") as tree:
        return tree.load()


def drawn(tree: Any, name: str) -> Any:
    """A figure of a dataset tree by its name, on no file."""
    return _draw(tree, name)


def _draw(tree: Any, name: str, of: str | None = None, over: str | None = None) -> Any:
    """A figure by its name."""
    from mpm.plots import layouts
    from mpm.plots.style import settle

    kinds = {"overview": layouts.overview, "series": layouts.all_series, "finals": layouts.all_finals}
    fig = kinds[name](_viewed(tree, of, over))
    settle(fig.axes)
    return fig


def _viewed(tree: Any, of: str | None = None, over: str | None = None) -> Any:
    """A dataset as figures see it, with what is to be drawn; UnknownFigure for names that it does not have."""
    from mpm.plots.view import View

    view = View(tree)
    for asked, known, what in ((of, view.finals, "final"), (over, view.along_names, "swept parameter")):
        if asked is not None and asked not in known:
            raise UnknownFigure(f"there is no {what} {asked!r}; there are {', '.join(known) or 'none'}")
    view.wanted, view.along = of, over
    return view


def _finish(fig: Any, path: Path | str | None) -> Any:
    """Write a figure where a path is given."""
    from mpm.plots.style import save

    if path is not None:
        save(fig, path)
    return fig
