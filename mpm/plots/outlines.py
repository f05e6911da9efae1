"""Outlines of what stands around the bodies: walls of the domain, tools and nozzles, as lines in space. Figures and movies draw them with `draw`.

A tool stands where its programme says: its path or velocity, its spin, `from` and `until`. How far a force has pushed a tool no dataset tells: such a tool
is drawn dotted where it began. A nozzle is drawn as long as something flows through it, open at both ends. Round shapes are polygons of ROUND sides; in 3-D
boxes are their edges, balls three circles, cylinders two circles and four lines.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from mpm.plots.style import INK, QUIET
from mpm.triangles import lines as lines_of_mesh

ROUND = 64
SIDES = {
    1: ("left", "right"),
    2: ("left", "right", "bottom", "top"),
    "axisymmetric": ("axis", "outer", "bottom", "top"),
    3: ("left", "right", "front", "back", "bottom", "top"),
}


def walls(config: dict[str, Any]) -> Iterator[tuple[np.ndarray, bool]]:
    """Sides of the domain as lines (K, D) [m], and whether the config names the side."""
    grid = config.get("grid") or {}
    size, dimension = np.asarray(grid.get("size", ()), float), grid.get("dimension")
    for number, side in enumerate(SIDES.get(dimension, ()) if len(size) else ()):
        axis, upper = number // 2, number % 2
        low, high = np.zeros(len(size)), size.copy()
        low[axis] = high[axis] = size[axis] * upper
        named = side in (config.get("walls") or {})
        if side == "axis":
            continue
        if dimension == 3:
            yield from ((line, named) for line in edges(low, high))
        else:
            yield np.array([low, high]), named


def tools(config: dict[str, Any], time: float) -> Iterator[tuple[str, list[np.ndarray], bool]]:
    """(name, lines (K, D) [m], whether their place is known) of each tool that is there at a time [s]."""
    dimension = (config.get("grid") or {}).get("dimension")
    for name, tool in (config.get("tools") or {}).items():
        until = tool.get("until")
        if time < tool["from"] or (until is not None and time >= until):
            continue
        lines, motion = shape(tool["shape"], dimension), tool.get("motion") or {}
        corners = np.concatenate(lines)
        centre = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        turn, moved = rotation(motion, time, len(centre)), centre + displacement(motion, time, len(centre))
        yield str(name), [(line - centre) @ turn.T + moved for line in lines], motion.get("force") is None


def nozzles(config: dict[str, Any], time: float) -> Iterator[tuple[str, list[np.ndarray], bool]]:
    """The same of each body that flows in at a time [s]: the sides of its nozzle."""
    dimension, method = (config.get("grid") or {}).get("dimension"), config.get("method") or {}
    for name, body in (config.get("bodies") or {}).items():
        flow = body.get("inflow") or {}
        if not flow or not flow["from"] <= time < (math.inf if flow.get("until") is None else flow["until"]):
            continue
        lines = shape(body["shape"], dimension)
        if dimension != 3:
            axis = next(a for a, entry in enumerate(flow.get("velocity") or config["gravity"]) if flows(entry))
            corners = np.concatenate(lines)
            low, high = corners.min(axis=0), corners.max(axis=0)
            sides = [np.array([low, high]) for _ in range(2)]
            for line, end in zip(sides, (low, high), strict=True):
                line[:, 1 - axis] = end[1 - axis]
            lines = sides[1:] if dimension == "axisymmetric" and low[0] <= 0.0 else sides
        shift = np.asarray(method.get("offset") or np.zeros(lines[0].shape[1])) * config["grid"]["cell"]
        yield str(name), [line + shift for line in lines], True


def flows(entry: Any) -> bool:
    """Whether an entry of a velocity is ever not zero."""
    return bool(np.any(entry["table"]["value"])) if isinstance(entry, dict) and "table" in entry else entry != 0


def displacement(motion: dict[str, Any], time: float, D: int) -> np.ndarray:
    """How far the centre has gone."""
    if (path := motion.get("path")) is not None:
        return np.array([np.interp(time, path["time"], along) for along in np.transpose(path["displacement"])])
    return np.zeros(D) if motion.get("velocity") is None else lasted(motion, time) * np.asarray(motion["velocity"], float)


def lasted(motion: dict[str, Any], time: float) -> float:
    """How long it has moved."""
    until = motion.get("until")
    return max(0.0, min(time, math.inf if until is None else until) - motion.get("from", 0.0))


def rotation(motion: dict[str, Any], time: float, D: int) -> np.ndarray:
    """R (D, D); Rodrigues' formula."""
    spin = motion.get("spin")
    if spin is None:
        return np.eye(D)
    if D == 2:
        angle = float(spin) * lasted(motion, time)
        return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    x, y, z = np.asarray(spin, float) * lasted(motion, time)
    angle = max(math.sqrt(x * x + y * y + z * z), 1e-300)
    W = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) / angle
    return np.eye(3) + math.sin(angle) * W + (1 - math.cos(angle)) * (W @ W)


def shape(said: dict[str, Any], dimension: Any) -> list[np.ndarray]:
    """Lines (K, D) of a shape of the config."""
    ((kind, about),) = said.items()
    if kind == "polygon":
        return [closed(np.asarray(about["vertices"], float))]
    if kind == "ball":
        centre, radius = np.asarray(about["centre"], float), float(about["radius"])
        if len(centre) == 1:
            return [np.array([centre - radius, centre + radius])]
        return [circle(centre, radius, pair) for pair in itertools.combinations(range(len(centre)), 2)]
    if kind == "cylinder":
        base, radius, height = np.asarray(about["base"], float), float(about["radius"]), float(about["height"])
        if dimension != 3:
            return [half(np.array([0.0, base[-1]]), np.array([radius, base[-1] + height]))]
        ends = [circle(base + np.array([0.0, 0.0, up]), radius, (0, 1)) for up in (0.0, height)]
        return ends + [np.array([ends[0][k], ends[1][k]]) for k in range(0, ROUND, ROUND // 4)]
    if kind == "mesh":
        return lines_of_mesh(about)
    lower, upper, angle = np.asarray(about["lower"], float), np.asarray(about["upper"], float), float(about.get("angle") or 0.0)
    if dimension == "axisymmetric" and lower[0] <= 0.0:
        return [half(lower, upper)]
    centre, turn = 0.5 * (lower + upper), rotation({"spin": angle}, 1.0, 2) if angle else np.eye(len(lower))
    return [(line - centre) @ turn.T + centre for line in edges(lower, upper)]


def half(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """A rectangle of r and z from the axis on, without the side that lies on the axis."""
    return np.array([low, [high[0], low[1]], high, [low[0], high[1]]])


def edges(low: np.ndarray, high: np.ndarray) -> list[np.ndarray]:
    """Edges of a box or of a flat side of one: a line, a loop, or two loops and four lines."""
    free = np.flatnonzero(high > low)
    if len(free) == 1:
        return [np.array([low, high])]
    loop = np.tile(low, (5, 1))
    loop[:, free[0]] = np.take([low[free[0]], high[free[0]]], [0, 1, 1, 0, 0])
    loop[:, free[1]] = np.take([low[free[1]], high[free[1]]], [0, 0, 1, 1, 0])
    if len(free) == 2:
        return [loop]
    top = loop.copy()
    top[:, free[2]] = high[free[2]]
    return [loop, top, *(np.array([loop[k], top[k]]) for k in range(4))]


def circle(centre: np.ndarray, radius: float, plane: tuple[int, int]) -> np.ndarray:
    """A circle in the plane of two directions."""
    angle, found = np.linspace(0.0, 2 * np.pi, ROUND + 1), np.tile(centre, (ROUND + 1, 1))
    found[:, plane[0]] += radius * np.cos(angle)
    found[:, plane[1]] += radius * np.sin(angle)
    return found


def closed(corners: np.ndarray) -> np.ndarray:
    """A polygon that ends where it began."""
    return np.concatenate([corners, corners[:1]])


def draw(ax: Any, lines: list[np.ndarray], shown: Callable[[np.ndarray], np.ndarray], mirrored: bool = False, **look: Any) -> list[Any]:
    """Draw lines; the artists. `shown` takes places (K, D) [m] to the panel (K, 2); `mirrored`: also the other half plane of r and z."""
    both = [*lines, *([line * [-1.0, 1.0] for line in lines] if mirrored else [])]
    artists = []
    for line in both:
        x, y = shown(line).T
        artists += ax.plot(x, y, scalex=False, scaley=False, **look)
    return artists


def draw_walls(ax: Any, config: dict[str, Any], shown: Callable[[np.ndarray], np.ndarray], mirrored: bool = False) -> None:
    """The domain; thick where the config names a side as a wall of its own."""
    behind = (config.get("grid") or {}).get("dimension") == 3
    for line, named in walls(config):
        draw(ax, [line], shown, mirrored, color=INK if named else QUIET, lw=2.0 if named else 0.7, zorder=1 if behind else 4)


def draw_tools(ax: Any, config: dict[str, Any], time: float, shown: Callable[[np.ndarray], np.ndarray], mirrored: bool = False) -> list[Any]:
    """The tools and nozzles that are there at a time [s]; the artists, so that a movie can take them away again."""
    found = []
    for _, lines, known in itertools.chain(tools(config, time), nozzles(config, time)):
        found += draw(ax, lines, shown, mirrored, color=INK, lw=1.4, ls="-" if known else ":", zorder=5)
    return found
