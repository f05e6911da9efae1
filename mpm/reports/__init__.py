"""Report: one HTML page of a sweep or a run that needs nothing else: no network, no file beside it.

Every text goes through jinja2's escaping, data through its JSON filter; the page's content security policy allows one style sheet and one script by their
hashes and pictures by data, nothing else. Where fit.nc, sensitivity.nc, stability.nc or chart.nc lies beside the sweep, its answer comes first. Without
JavaScript all of it can be read; with it a chart of any two columns and a brush over all parameters.

May use     opened, plots, jinja2                                                       May not  see config, sweep or anything that computes

Further files
    content     what a page says of a sweep, in words and tables
    studies     the same of a fit, a sensitivity analysis, a stability map and a chart
"""

import base64
import hashlib
import io
import os
from pathlib import Path
from typing import Any

from mpm.opened import Results
from mpm.plots import place
from mpm.reports.content import content, shown
from mpm.reports.studies import studies

HERE = Path(__file__).parent
MOVIE = 1_500_000  # bytes of a movie beside the dataset that is put into the page
RASTER = 400  # points from which figures are PNG: an SVG of thousands of marks is larger


def report(out: Path | str, to: Path | str | None = None) -> Path:
    """Write the page; its path. The same as `mpm report`.

    out    folder of a sweep or a run, or a dataset file
    to     OUT/report.html unless given
    Raises FileNotFoundError where there is no dataset.
    """
    with Results(out) as found:
        target = place(Path(to) if to is not None else found.path.with_name("report.html"))
        text = page(found)
    temporary = target.with_name(f".{target.stem}.{os.getpid()}{target.suffix}")
    try:
        temporary.write_text(text, encoding="utf-8", errors="backslashreplace")
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)
    return target


def page(found: Results) -> str:
    """The HTML."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup  # of our own two files alone

    style, script = ((HERE / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    made = Environment(loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    studied = beside(found)
    parts = content(found, [one["name"] for one in studied]) | {"studies": studied, "figures": figures(found), "movie": movie(found)}
    policy = f"default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; style-src '{digest(style)}'; script-src '{digest(script)}'"
    return made.get_template("page.html").render(parts | {"shown": shown, "policy": policy, "style": Markup(style), "script": Markup(script)})


def digest(text: str) -> str:
    """A source of the content security policy."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def figures(found: Results) -> list[dict[str, Any]]:
    """Figures as pictures in the page, each with what it shows in words."""
    from mpm.plots import drawn, words

    view, made = found.view, []
    said = lambda names, none: ", ".join(words.short(view.long_name(name)) for name in names) or none  # noqa: E731
    varied = " and ".join(axis.name for axis in view.axes) or view.design or "time"
    kinds = [("overview", f"Overview: {said(view.finals[:2], 'no result')}, over {varied}.")]
    if (view.axes or view.design) and (view.series_names() or not view.ok.any()):
        kinds.append(("series", f"Over time: {said(view.series_names()[:3], 'nothing')}, of a few points."))
    if found.points()[0].shots.times.size:
        kinds.append(("snapshot", "Snapshots of the point that stands for the sweep."))
    for name, alt in kinds:
        figure = snapshots(found) if name == "snapshot" else drawn(found.tree, name)
        if figure is None:
            continue
        made.append({"name": name, "alt": alt, "source": picture(figure, raster=view.status.size > RASTER or name == "snapshot")})
    return made


def picture(figure: Any, raster: bool) -> str:
    """A figure as the address of its own data: SVG, or PNG where that is smaller."""
    from mpm.plots.style import settle, styled

    buffer, kind = io.BytesIO(), "png" if raster else "svg"
    with styled():
        settle(figure.axes)
        figure.savefig(buffer, format=kind, dpi=110, metadata=None if raster else {"Date": None})
    return f"data:image/{'png' if raster else 'svg+xml'};base64,{base64.b64encode(buffer.getvalue()).decode()}"


def beside(found: Results) -> list[dict[str, Any]]:
    """The studies that lie beside the dataset, with their figures as pictures."""
    made = list(studies(found.path.parent))
    return [one | {"source": picture(one["figure"], raster=found.view.status.size > RASTER)} for one in made]


def snapshots(found: Results) -> Any:
    """A still of the chosen point; None where its snapshots cannot be drawn."""
    from mpm.movies import MovieError, still

    try:
        return still(found.path)
    except MovieError:
        return None


def movie(found: Results) -> str:
    """The movie beside the dataset, if it is small."""
    path = found.path.with_name("movie.webp")
    there = path.is_file() and path.stat().st_size <= MOVIE
    return f"data:image/webp;base64,{base64.b64encode(path.read_bytes()).decode()}" if there else ""
