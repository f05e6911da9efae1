"""One panel of a movie or a still: a snapshot's particles or its field on the grid, in the domain with its walls."""

from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize

from mpm.movies import MovieError
from mpm.opened import Point, Results
from mpm.plots import words
from mpm.plots.outlines import draw_tools, draw_walls, tools
from mpm.plots.style import QUIET
from mpm.records.variables import VARIABLES
from mpm.text import visible

FIRST = ("temperature", "stress_mises", "pressure", "J", "velocity", "density", "body")
BESIDE, BESIDE_WALL = 0.6, 0.1  # of the particles' extent
BALLS = 3.0  # square points of a dot that is large enough to be shaded as a ball
LEAST = 1e-6  # Pa: less is round-off
LETTERS = 14  # of a title in an inch of its panel
SAMPLES = 12  # snapshots that the limits of colour and space are taken from
COLOURS = ListedColormap(matplotlib.colormaps["inferno"](np.linspace(0.0, 0.9, 256)), "inferno without its palest end")  # which white paper swallows
SIDE, UP = np.radians(35.0), np.radians(22.0)  # from where three directions are seen


@dataclass(frozen=True)
class Look:
    """What all panels share."""

    field: str
    on_grid: bool
    dimension: Any
    mirrored: bool
    config: dict[str, Any]  # resolved
    box: np.ndarray  # (2, 2): lower and upper corner of what is shown [m]
    length: words.Scale
    scale: words.Scale
    clock: words.Scale
    mappable: Any
    label: str

    @property
    def aspect(self) -> float:
        """Height over width."""
        width, height = self.box[1] - self.box[0]
        return float(height / max(width, 1e-300))


def looks(found: Results, shown: list[Point], of: str | None) -> Look:
    """The look that fits all points: limits of space and colour from a few of their snapshots."""
    some = [point.shots[int(k)] for point in shown for k in np.unique(np.linspace(0, len(point.shots) - 1, SAMPLES).round())]
    field, on_grid = chosen(some, of)
    values = np.concatenate([valued(frame, field, on_grid).ravel() for frame in some])
    units = VARIABLES[field].units if field in VARIABLES else "1"
    scale = words.scale(values, units, words.is_temperature(field))
    finite = scale(values[np.isfinite(values)])
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-300):
        low, high = low - 0.5, high + 0.5  # one value everywhere
    dimension, config = found.dimension, found.view.config
    mirrored = dimension == "axisymmetric"
    solid = [flat(frame.particles["position"], dimension) for frame in some] if not on_grid else [edges(point.shots.axes) for point in shown]
    places = np.concatenate([place[:, :2] for place in solid])
    box = np.array([places.min(axis=0), places.max(axis=0)])
    if mirrored:
        box[0, 0], box[1, 0] = -np.abs(box[:, 0]).max(), np.abs(box[:, 0]).max()
    box = with_tools(with_walls(box, config, mirrored), config, some, mirrored)
    margin = 0.06 * max(np.ptp(box, axis=0).max(), 1e-12)
    box = box + np.array([[-margin], [margin]])
    name = words.title_case(words.short(VARIABLES[field].long_name)) if field in VARIABLES else field
    bare = ScalarMappable(Normalize(low, high), COLOURS)
    times = words.scale(shown[0].shots.times, "s")
    return Look(field, on_grid, dimension, mirrored, config, box, words.scale(box, "m"), scale, times, bare, words.with_units(name, scale.units))


def with_walls(box: np.ndarray, config: dict[str, Any], mirrored: bool) -> np.ndarray:
    """What is shown, in the plane up to the border of the domain where that is near: the wall there belongs to the picture."""
    size = np.array((config.get("grid") or {}).get("size", ()), float)
    if size.shape != (2,):
        return box
    border = np.array([[-size[0] if mirrored else 0.0, 0.0], size])
    return np.where(np.abs(box - border) < BESIDE_WALL * np.ptp(box, axis=0).max(), border, box)


def with_tools(box: np.ndarray, config: dict[str, Any], some: list[Any], mirrored: bool) -> np.ndarray:
    """What is shown, and of the tools as much as lies within BESIDE of its size around it."""
    lines = [flat(line, (config.get("grid") or {}).get("dimension"))[:, :2] for frame in some for _, every, _ in tools(config, frame.time) for line in every]
    if not lines:
        return box
    corners, around = np.concatenate(lines), BESIDE * np.ptp(box, axis=0).max()
    corners = np.concatenate([corners, corners * [-1.0, 1.0]]) if mirrored else corners
    low, high = np.clip([corners.min(axis=0), corners.max(axis=0)], box[0] - around, box[1] + around)
    return np.array([np.minimum(box[0], low), np.maximum(box[1], high)])


def chosen(frames: list[Any], of: str | None) -> tuple[str, bool]:
    """The field to show, and whether it is the grid's: of those that differ from place to place or in time the first of FIRST."""
    frame = frames[0]
    here = "position" in frame.particles
    particles = [name for name in frame.particles if name not in ("position", "id")] if here else []
    if of is not None:
        if of in particles or of in frame.grid:
            return of, of not in particles
        raise MovieError(f"the snapshots have no field {visible(of)!r}; there are {', '.join(dict.fromkeys([*particles, *frame.grid])) or 'none'}")
    for names, on_grid in ((particles, False), (list(frame.grid), True)):
        if names:
            order = [*(name for name in FIRST if name in names), *(name for name in names if name not in FIRST)]
            return next((name for name in order if differs(frames, name, on_grid)), order[0]), on_grid
    return "position", False


def differs(frames: list[Any], field: str, on_grid: bool) -> bool:
    """Whether a field has different values, beyond round-off."""
    values = np.concatenate([valued(frame, field, on_grid).ravel() for frame in frames])
    values, floor = values[np.isfinite(values)], LEAST if VARIABLES.get(field) and VARIABLES[field].units == "Pa" else 0.0
    return bool(values.size and np.ptp(values) > max(1e-6 * np.abs(values).max(), floor))


def valued(frame: Any, field: str, on_grid: bool) -> np.ndarray:
    """What colours tell; of vectors and tensors their size."""
    values = np.asarray((frame.grid if on_grid else frame.particles)[field], float)
    return np.linalg.norm(values, axis=1) if values.ndim > 1 and not on_grid else values


def flat(x: np.ndarray, dimension: Any) -> np.ndarray:
    """Places on the panel, and how near they are: (N, 3)."""
    x = np.asarray(x, float).reshape(len(x), -1)
    if x.shape[1] < 3:
        return np.column_stack([x[:, 0], x[:, 1] if x.shape[1] > 1 else np.zeros(len(x)), np.zeros(len(x))])
    across, toward = x[:, 0] * np.cos(SIDE) + x[:, 1] * np.sin(SIDE), x[:, 0] * np.sin(SIDE) - x[:, 1] * np.cos(SIDE)
    return np.column_stack([across, x[:, 2] * np.cos(UP) - toward * np.sin(UP), toward * np.cos(UP) + x[:, 2] * np.sin(UP)])


def edges(axes: dict[str, np.ndarray]) -> np.ndarray:
    """Corners of the grid, as places on the panel."""
    first, *rest = reversed(axes.values())
    up = rest[-1] if rest else np.zeros(1)
    return np.array([[first[0], up[0], 0.0], [first[-1], up[-1], 0.0]])


class Stage:
    """A panel. `show(frame)` draws a snapshot in the place of the one before."""

    def __init__(self, ax: Any, look: Look, label: str, axes: dict[str, np.ndarray]):
        self.ax, self.look, self.named, self.axes = ax, look, label, axes
        self.drawn: list[Any] = []
        ax.set_aspect("equal" if look.dimension != 1 else "auto")
        ax.grid(False)
        ax.set_xlim(*look.length(look.box[:, 0]))
        low, high = look.mappable.get_clim()
        ax.set_ylim(*(look.length(look.box[:, 1]) if look.dimension != 1 else (low - 0.06 * (high - low), high + 0.06 * (high - low))))
        if look.dimension != 1:
            draw_walls(ax, look.config, self.place, look.mirrored)
        if look.mirrored:
            ax.axvline(0.0, color=QUIET, lw=0.6, ls=(0, (4, 3)), zorder=4)

    def label(self, left: bool, foot: bool) -> None:
        """Names of the axes."""
        look, letters = self.look, {1: "x ", 2: "xy", "axisymmetric": "rz", 3: "  "}[self.look.dimension]
        if foot:
            self.ax.tick_params(labelbottom=True)
            self.ax.set_xlabel(words.with_units(letters[0].strip() or "seen from the side", look.length.units))
        if left and (letters[1].strip() or look.dimension == 1):
            self.ax.set_ylabel(words.with_units(letters[1], look.length.units) if look.dimension != 1 else look.label)

    def place(self, x: np.ndarray) -> np.ndarray:
        """Where places (K, D) [m] lie on the panel (K, 2)."""
        if self.look.on_grid and self.look.dimension == 3:  # the slice through the middle
            return self.look.length(x[:, [0, 2]])
        return self.look.length(flat(x, self.look.dimension)[:, :2])

    def show(self, frame: Any, lines: bool = False) -> None:
        """Draw a snapshot; on the grid with `lines` of equal value."""
        look = self.look
        for artist in self.drawn:
            artist.remove()
        self.drawn = draw_tools(self.ax, look.config, frame.time, self.place, look.mirrored) if look.dimension != 1 else []
        values = look.scale(valued(frame, look.field, look.on_grid))
        (self.on_grid if look.on_grid else self.particles)(frame, values, lines)
        when = f"t = {words.number(float(look.clock(frame.time)))} {look.clock.units}".strip()
        text, letters = f"{self.named}, {when}" if self.named else when, int(self.ax.get_position().width * self.ax.figure.get_figwidth() * LETTERS)
        self.ax.set_title(text if len(text) <= letters else f"{words.wrapped(self.named, letters)}\n{when}", fontsize=8.5)

    def particles(self, frame: Any, values: np.ndarray, lines: bool) -> None:
        """A dot a particle, about as large as its share of the space."""
        look, place = self.look, flat(frame.particles["position"], self.look.dimension)
        if look.dimension == 1:
            self.profile(place[:, 0], values)
            return
        colours = look.mappable.to_rgba(values)
        if look.mirrored:
            place, colours = np.concatenate([place * [-1, 1, 1], place]), np.concatenate([colours, colours])
        dot = self.dot(len(place))
        if look.dimension == 3:
            order = np.argsort(place[:, 2], kind="stable")
            place, colours = place[order], colours[order]
            near = (place[:, 2] - place[0, 2]) / max(np.ptp(place[:, 2]), 1e-300)
            colours[:, :3] *= (0.55 + 0.45 * near)[:, None]
        places, size = look.length(place[:, :2]), np.full(len(place), dot)
        if look.dimension == 3 and dot > BALLS:
            places, colours, size = self.balls(places, colours, dot)
        self.drawn.append(self.ax.scatter(*places.T, c=colours, s=size, lw=0, zorder=3, rasterized=True))

    def profile(self, x: np.ndarray, values: np.ndarray) -> None:
        """In 1-D values over the line."""
        self.drawn.append(self.ax.scatter(self.look.length(x), values, c=self.look.mappable.to_rgba(values), s=14, lw=0))

    def balls(self, places: np.ndarray, colours: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Each particle as three dots, one on the other: its rim, itself and a light from above on the left. Those behind stay behind."""
        points = np.ptp(self.ax.get_xlim()) / (self.ax.get_position().width * self.ax.figure.get_figwidth() * 72)  # of the panel's unit
        shift, share = np.array([0.0, -0.06, -0.16]) * 2 * np.sqrt(size) * points, np.array([1.0, 0.68, 0.1])
        every = np.repeat(places, 3, axis=0) + np.tile(np.outer(shift, [1.0, -1.0]), (len(places), 1))
        tints = np.repeat(colours, 3, axis=0)
        tints[0::3, :3] *= 0.62
        tints[2::3, :3] += 0.55 * (1.0 - tints[2::3, :3])
        return every, tints, np.tile(share * size, len(places))

    def dot(self, count: int) -> float:
        """Area of a dot in square points, so that particles that fill a third of the panel about touch."""
        width, height = self.ax.get_position().size * self.ax.figure.get_size_inches() * 72
        count = 3.0 * count ** (2.0 / 3.0) if self.look.dimension == 3 else count  # those on the three sides that are seen
        return float(np.clip(0.6 * width * height / max(count, 1), 0.3, 60.0))

    def on_grid(self, frame: Any, values: np.ndarray, lines: bool) -> None:
        """A field on the grid: in 3-D the slice through the middle."""
        look = self.look
        axes = list(self.axes.values())
        if values.ndim == 3:
            values, axes = values[:, values.shape[1] // 2], [axes[0], axes[2]]
        across, up = look.length(axes[-1]), look.length(axes[0]) if values.ndim == 2 else None
        if up is None:
            self.profile(axes[0], values)
            return
        if look.mirrored:
            across, values = np.concatenate([-across[:0:-1], across]), np.concatenate([values[:, :0:-1], values], axis=1)
        shades = {"cmap": look.mappable.cmap, "norm": look.mappable.norm, "shading": "nearest", "rasterized": True}
        self.drawn.append(self.ax.pcolormesh(across, up, values, **shades))
        finite = values[np.isfinite(values)]
        if lines and finite.size and np.ptp(finite) > 1e-6 * max(1.0, np.abs(finite).max()):
            found = self.ax.contour(across, up, values, levels=6, colors="white", linewidths=0.7, linestyles="solid")
            if places := long_enough(found, 0.3 * np.ptp(self.ax.get_xlim())):
                self.ax.clabel(found, fontsize=7, fmt=words.number, manual=places)


def long_enough(contours: Any, least: float) -> list[tuple[float, float]]:
    """A place for the label of each level: the middle of its longest line, if that is long enough for a number."""
    found = []
    for lines in contours.allsegs:
        lengths = [np.abs(np.diff(line, axis=0)).sum() for line in lines if len(line) > 1]
        if lengths and max(lengths) >= least:
            longest = [line for line in lines if len(line) > 1][int(np.argmax(lengths))]
            found.append(tuple(longest[len(longest) // 2]))
    return found
