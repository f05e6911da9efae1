"""In a notebook: results that show themselves, and a progress bar; elsewhere the same without either. `mpm.run` and `mpm.sweep` are these.

    tree = mpm.sweep(experiment)     a bar while it runs
    tree                             what varied, how many points are ok, what went wrong, the overview; below it the tree as xarray shows it

May use     sweep, plots, reports (words of a page)                                     May not  compute
"""

import base64
import html
import io
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray

from mpm.sweep.report import Reporter


class Results(xarray.DataTree):
    """A dataset that shows itself in a notebook; all else is an xarray.DataTree."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        try:
            return card(self) + f"<details><summary>The dataset</summary>{super()._repr_html_()}</details>"
        except (KeyError, ValueError, TypeError):  # a part that was cut out of a dataset: it has no status, or no longer its dimensions
            return super()._repr_html_()


def shown(tree: xarray.DataTree) -> Results:
    """The same tree, which shows itself."""
    return Results.from_dict({node.path: node.to_dataset(inherit=False) for node in tree.subtree}, name=tree.name)


def card(tree: xarray.DataTree) -> str:
    """Title, what varied, status, reasons, warnings, and the overview as a picture. Every text is escaped."""
    from mpm.plots import overview
    from mpm.plots.style import styled
    from mpm.plots.view import View
    from mpm.records.variables import STATUS
    from mpm.reports.content import failures, varied, warnings

    view = View(tree)
    rows = [varied(axis, view) for axis in (view.parameters if view.design is not None else view.axes)]
    parts = [f"<h4>{html.escape(view.title)}</h4>", "<ul>"]
    parts += [f"<li>{html.escape(row['name'])}: {html.escape(row['said'])}</li>" for row in rows]
    counts = {STATUS[code]: int((view.status == code).sum()) for code in sorted({int(code) for code in view.status.ravel()})}
    parts.append(f"<li>{', '.join(f'{count} {name}' for name, count in counts.items())}</li>")
    parts += [f"<li>{row['count']} x {html.escape(row['reason'])}. {html.escape(row['advice'])}</li>" for row in failures(view)]
    parts += [f"<li>{row['count']} with a warning: {html.escape(row['example'])}</li>" for row in warnings(view)]
    buffer = io.BytesIO()
    with styled():
        overview(tree).savefig(buffer, format="png", dpi=90)
    picture = base64.b64encode(buffer.getvalue()).decode()
    return "".join([*parts, "</ul>", f'<img alt="Overview" style="max-width:100%" src="data:image/png;base64,{picture}">'])


def in_notebook() -> bool:
    """Whether a Jupyter kernel runs this."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return getattr(shell, "kernel", None) is not None


class Bar(Reporter):
    """A progress bar in the cell's output. It needs IPython alone, no widgets."""

    def __init__(self) -> None:
        from IPython.display import HTML, display

        self.html, self.handle = HTML, display(HTML(""), display_id=True)
        self.total = self.done = self.failed = 0
        self.said, self.part = "", 0.0
        self.notes: list[str] = []

    def write(self) -> None:
        """Show how far it is."""
        least = f'<progress value="{self.done + self.part:.3f}" max="{max(self.total, 1)}"></progress>'
        failed = f", {self.failed} failed" if self.failed else ""
        lines = "".join(f"<br>{html.escape(line)}" for line in self.notes[-5:])
        self.handle.update(self.html(f"{least} {self.done} of {self.total}{failed} {html.escape(self.said)}{lines}"))

    def start(self, total: int, done: int, jobs: int) -> None:
        """Show the bar."""
        self.total, self.done = total, done
        self.write()

    def beat(self, running: dict[str, float]) -> None:
        """The bar moves with the fractions of what runs."""
        self.part = sum(running.values())
        self.write()

    def finished(self, label: str, line: dict, again: bool) -> None:
        """One more point; why one failed is told below the bar."""
        self.done += not again
        self.part = 0.0
        if line["status"] != 0:
            self.failed += not again
            self.notes.append(f"{label or 'the point'}: {line['error']}")
        self.write()

    def compiling(self, text: str, expected: float) -> None:
        """What is compiled, behind the bar."""
        self.said = text
        self.write()

    def note(self, text: str) -> None:
        """A line below the bar."""
        self.notes.append(text)
        self.write()

    def close(self) -> None:
        """The bar says no more."""
        self.said = ""
        self.write()


def loaded(experiment: Any) -> Any:
    """The experiment, read first where it is a file or a dict."""
    from mpm.config import load

    return load(experiment) if isinstance(experiment, (str, Path, dict)) else experiment


def run(experiment: Any, beat: Callable[[float, float], bool] | None = None, threads: int = 1) -> Results:
    """`mpm.run`: the first point as an xarray.DataTree (/, series, grid, particles). A point that fails is `status` 4 with its `error`, not an exception.

    experiment  of `mpm.load`, or what it loads: a file, or a dict
    beat      called with (fraction, time [s]); whether to stop. In a notebook a bar unless given.
    threads   that share the work of one large run
    """
    from mpm import compiling
    from mpm.sweep import api

    experiment = loaded(experiment)
    if beat is not None or not in_notebook():
        return shown(api.run(experiment, beat, threads))
    bar = Bar()
    bar.start(1, 0, 1)

    def heard(fraction: float, when: float) -> bool:
        bar.beat({"": fraction})
        return False

    with compiling.say(lambda text, expected, took: bar.compiling(text, expected)):
        tree = api.run(experiment, heard, threads)
    bar.finished("", {"status": int(tree["status"]), "error": str(tree["error"].values) if "error" in tree else ""}, False)
    bar.close()
    return shown(tree)


def sweep(experiment: Any, out: Path | str | None = None, jobs: int | str = "auto", max_runs: int = 10_000, reporter: Any = None, **more: Any) -> Results:
    """`mpm.sweep`: see `mpm.sweep.api.sweep`; in a notebook with a bar unless a reporter is given."""
    from mpm.sweep import api

    return shown(api.sweep(loaded(experiment), out, jobs, max_runs, reporter or (Bar() if in_notebook() else None), **more))
