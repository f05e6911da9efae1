"""How figures look: one style, palettes that colour-blind readers can tell apart, and files written whole.

Figures are made without pyplot: no window, no global state, safe in any process or thread. 1600 px wide at 150 dpi.
"""

import contextlib
import io
import math
import os
import secrets
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import Formatter, LogFormatter, LogLocator, NullFormatter, ScalarFormatter
from matplotlib.transforms import ScaledTranslation

from mpm.plots.axis import room
from mpm.plots.words import number, numbers, wrapped
from mpm.text import visible

WIDTH, DPI = 1600 / 150, 150
INK, QUIET, FAINT = "#222222", "#6b6b6b", "#d9d9d9"
OKABE_ITO = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")  # Okabe and Ito (2008)
DASHES = ("-", (0, (5, 2)), (0, (1.2, 1.6)), (0, (6, 2, 1.2, 2)), (0, (3, 1, 1, 1, 1, 1)))
SMALL, HEADING = 9, "heading"
LONGEST = 150  # letters of a title
LINE = 84  # letters of a line of it
SMALLEST, LARGEST = 1e-3, 1e5  # of an axis in plain numbers
MARKS = ("x", "+", "1", "2", "3", "4")
STYLE: dict[Any, Any] = {
    "font.size": 10,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 8,
    "axes.labelsize": 10,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 6),
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.7,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "text.color": INK,
    "text.parse_math": False,  # a title with dollars is a title
    "lines.linewidth": 1.8,
    "lines.markersize": 5,
    "legend.frameon": False,
    "legend.fontsize": SMALL,
    "legend.title_fontsize": 9,
    "legend.handlelength": 2.4,
    "figure.titlesize": 13,
    "figure.titleweight": "bold",
    "figure.dpi": DPI,
    "savefig.dpi": DPI,
    "svg.hashsalt": "mpm",
}


@contextlib.contextmanager
def styled() -> Iterator[None]:
    """Our style while this lasts, and the user's again after."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        yield


class Picture(Figure):
    """A figure without pyplot, which a notebook shows all the same."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        with styled():
            self.savefig(buffer, format="png", dpi=90)
        return buffer.getvalue()


def figure(title: str, height: float) -> Figure:
    """An empty figure with its title."""
    fig = Picture(figsize=(WIDTH, height), layout=ConstrainedLayoutEngine(w_pad=0.12, h_pad=0.1, wspace=0.04, hspace=0.06))
    title = title if len(title) <= LONGEST else title[: LONGEST - 1] + "…"
    fig.suptitle(title if len(title) <= LINE else wrapped(title, LINE), x=0.012, ha="left")
    return fig


def ordered(count: int) -> list[Any]:
    """Colours that keep an order: viridis without its palest end."""
    return [tuple(map(float, colour)) for colour in matplotlib.colormaps["viridis"](np.linspace(0.0, 0.84, count))] if count > 1 else [OKABE_ITO[0]]


def legend_below(ax: Any, rows: list[list[Any]]) -> None:
    """Legends under the axis label, a row each or more where a row is too wide, where they cover nothing."""
    place = ax.get_subplotspec()  # axes that were placed by hand have none
    room = 0.82 * ax.figure.bbox.width / ax.figure.dpi * 72 / (place.get_gridspec().ncols if place is not None else 1)
    for place, handles in enumerate(line for row in rows for line in broken(row, room)):
        length = max(handle_length(handle) for handle in handles)
        back = (length + 0.6) * SMALL if handles[0].get_gid() == HEADING else 0.0  # a heading has no handle: its words begin the row
        drop = ScaledTranslation(-back / 72, -(44 + 16 * place) / 72, ax.figure.dpi_scale_trans)
        found = Legend(
            ax,
            handles,
            [handle.get_label() for handle in handles],
            loc="upper left",
            bbox_to_anchor=(0.0, 0.0),
            bbox_transform=ax.transAxes + drop,
            ncols=len(handles),
            handlelength=length,
            columnspacing=1.3,
            handletextpad=0.6,
            borderaxespad=0,
            borderpad=0,
        )
        ax.add_artist(found)
        found.set_clip_on(False)  # else the layout leaves no room for it


def broken(row: list[Any], room: float) -> list[list[Any]]:
    """A row of legend entries in as many as it takes to keep within `room` points."""
    lines: list[list[Any]] = []
    left = 0.0
    for handle in row:
        width = 5.2 * len(handle.get_label()) + (1.9 + handle_length(handle)) * SMALL
        if not lines or width > left:
            lines.append([])
            left = room
        lines[-1].append(handle)
        left -= width
    return lines


def handle_length(handle: Any) -> float:
    """Room for the mark of a legend entry, in letters: dashes take more than lines, lines more than marks, words alone none."""
    if handle.get_gid() == HEADING:
        return 0.0
    return 1.0 if handle.get_linestyle() == "None" else 1.8 if handle.get_linestyle() == "-" else 2.6


def plain_ticks(axis: Any) -> None:
    """Ticks of a logarithmic axis at 1, 2 and 5 where it spans little, in plain numbers where they read well."""
    low, high = sorted(axis.get_view_interval())
    decades = math.log10(high / low) if low > 0 else 0.0
    letters = room(axis.axes) if axis.axis_name == "x" else math.inf
    closer = ((1.0, 2.0, 5.0), (1.0, 3.0)) if decades < 1.7 else ()
    subs = next((subs for subs in closer if decades * len(subs) * (len(number(high)) + 1) < letters), (1.0,))
    axis.set_major_locator(LogLocator(subs=subs, numticks=12))
    axis.set_major_formatter(Plain())
    axis.set_minor_formatter(NullFormatter())


def level(ax: Any, values: np.ndarray, share: float) -> None:
    """A vertical axis on which finite values that are the same to `share` of themselves make a level line, not noise."""
    middle = float(values.mean()) if values.size else 0.0
    low, high = ax.get_ylim()
    if values.size and np.ptp(values) <= share * np.abs(values).max() and high - low < 1e-3 * abs(middle):
        ax.set_ylim(middle - 0.05 * abs(middle), middle + 0.05 * abs(middle))


class Plain(Formatter):
    """Ticks in our own numbers, in as many digits as tell them apart."""

    def __call__(self, value: float, place: int | None = None) -> str:
        return number(value)

    def format_ticks(self, values: Any) -> list[str]:
        """All ticks, with as many digits as tell them apart."""
        return numbers(map(float, values))


def settle(axes: Iterable[Any]) -> None:
    """Ticks in our own numbers wherever matplotlib would write mathematics or put a factor at the end of the axis."""
    for axis in (axis for ax in axes for axis in (ax.xaxis, ax.yaxis)):
        formatter, span = axis.get_major_formatter(), np.abs(axis.get_view_interval()).max()
        if isinstance(formatter, LogFormatter):
            plain_ticks(axis)
        elif isinstance(formatter, ScalarFormatter) and not SMALLEST <= span < LARGEST:
            axis.set_major_formatter(Plain())


def heading(text: str) -> Any:
    """A legend entry that is words alone: the title of its row."""
    return Line2D([], [], ls="None", label=text, gid=HEADING)


def save(fig: Figure, path: Path | str) -> Path:
    """Write PNG, SVG or PDF, by the suffix: beside the target first, then renamed over it. A letter that no font here has is a box."""
    path = Path(path)
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(4)}{path.suffix}")
    try:
        with styled(), warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph .* missing from")
            settle(fig.axes)
            for text in fig.findobj(Text):  # users' words are in titles, legends and labels: an SVG with control characters is none
                text.set_text(visible(text.get_text(), keep="\n"))
            fig.savefig(temporary, metadata={"Date": None} if path.suffix.lower() == ".svg" else None)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    return path
