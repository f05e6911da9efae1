"""Movies and stills: snapshots of one or several points, side by side, in one colour scale.

    movie(out, points, to)     .webp or .gif by Pillow; .mp4 by PyAV (pip install 'mpm[mp4]')
    still(out, points, to)     a few times in one picture (PNG, SVG, PDF); lines of equal temperature on the grid
    stage.py                   one panel: particles or a field on the grid, mirrored about the axis, with the walls of the domain

Three directions are shown from the side, by depth: near particles cover far ones and are brighter. Beyond some 1e6 particles a program of its own does
better: `mpm export --to FILE.vtkhdf` and ParaView.
May use     opened, plots                                                              May not  see config, sweep or anything that computes
"""

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from mpm.opened import Point, Results, UnknownPoint

MOVIES, STILLS = (".webp", ".gif", ".mp4"), (".png", ".svg", ".pdf")
RATE, LONGEST, DPI = 12.0, 8.0, 100  # frames a second, at least; seconds that a movie takes unless told


class MovieError(ValueError):
    """What cannot be shown so, with what would do."""


def movie(
    out: Path | str,
    points: str | Iterable[str] = (),
    to: Path | str | None = None,
    of: str | None = None,
    every: int = 1,
    speed: float | None = None,
    size: tuple[int, int] = (600, 400),
    told: Callable[[int, int], None] = lambda done, frames: None,
) -> Path:
    """Write a movie of snapshots; its path. The same as `mpm movie`.

    out, points  as in `mpm.export`; several points are shown side by side
    to       OUT/movie.webp unless given;  of: the field that colours tell (temperature, else what there is)
    every    of so many snapshots one is shown;  speed: seconds of the run a second of the movie; LONGEST seconds in all unless given
    size     pixels;  told(done, frames) hears of progress
    """
    from mpm.plots import place

    with Results(out) as found:
        target = Path(to) if to is not None else found.path.with_name("movie.webp")
        if target.suffix.lower() not in MOVIES:
            raise MovieError(f"{target}: a movie is written as {', '.join(MOVIES)}")
        shown = seen(found, points)
        place(target)
        times = shown[0].shots.times[:: max(1, every)]
        span = float(times[-1] - times[0])
        each = (span / speed if speed else min(LONGEST, max(len(times) / RATE, 1.0))) / max(1, len(times) - 1)  # s a frame
        fig, stages = canvas(found, shown, of, (size[0] / DPI, size[1] / DPI), 1)
        return write(target, pictures(fig, stages, shown, times, told), each)


def still(out: Path | str, points: str | Iterable[str] = (), to: Path | str | None = None, of: str | None = None, at: Iterable[float] = ()) -> Any:
    """A picture of a point, or of several, at some times [s] (four, evenly spread, unless given); the figure, and its file where `to` is given."""
    from mpm.plots import place
    from mpm.plots.style import save
    from mpm.plots.view import spread

    with Results(out) as found:
        shown = seen(found, points)
        every = shown[0].shots.times
        chosen = [float(every[np.argmin(np.abs(every - when))]) for when in at] or [float(every[i]) for i in spread(len(every), 4)]
        fig, stages = canvas(found, shown, of, None, len(chosen))
        for row, point in enumerate(shown):
            for column, when in enumerate(chosen):
                stages[row * len(chosen) + column].show(nearest(point, when), lines=True)
        if to is not None:
            if Path(to).suffix.lower() not in STILLS:
                raise MovieError(f"{to}: a picture is written as {', '.join(STILLS)}")
            save(fig, place(Path(to)))
        return fig


def seen(found: Results, points: str | Iterable[str]) -> list[Point]:
    """The points that are named, if they can be drawn."""
    shown = found.points([points] if isinstance(points, str) else points)
    for point in shown:
        name = f"{found.path}{': ' if point.label else ''}{point.label}"
        if not len(point.shots):
            raise UnknownPoint(f"{name}: there are no snapshots; output.snapshots in the config asks for them")
        frame = point.shots[0]
        if "position" not in frame.particles and not frame.grid:
            raise MovieError(f"{name}: the snapshots hold no positions; add position to output.snapshots.particles")
    return shown


def nearest(point: Point, when: float) -> Any:
    """The snapshot of a point nearest to a time."""
    return point.shots[int(np.argmin(np.abs(point.shots.times - when)))]


def canvas(found: Results, shown: list[Point], of: str | None, inches: tuple[float, float] | None, columns: int) -> tuple[Any, list[Any]]:
    """A figure with a panel for each point (a row each where there are several columns), and one colour bar."""
    from mpm.movies.stage import Stage, looks
    from mpm.plots.style import Picture, styled
    from mpm.plots.words import wrapped

    look = looks(found, shown, of)
    across, down = (columns, len(shown)) if columns > 1 else (wide := len(shown) if len(shown) <= 2 else 3 if len(shown) != 4 else 2, -(-len(shown) // wide))
    every = [point.label.split(", ") for point in shown]
    common = [text for text in every[0] if all(text in one for one in every)]
    names = [", ".join(text for text in one if text not in common) for one in every]
    title = found.view.title + (f" ({', '.join(common)})" if common != [""] and common else "")
    with styled():
        if inches is None:
            each = 9.3 / across
            inches = (10.6, min(24.0, max(1.5, each * look.aspect + 0.9) * down + 0.9))
        fig = Picture(figsize=inches, layout="constrained", dpi=DPI)
        fig.suptitle(wrapped(title, int(9.5 * inches[0])), fontsize=10.5, x=0.01, ha="left")
        panels = list(fig.subplots(down, across, squeeze=False, sharex=True, sharey=True).ravel())
        of_panel = [k // columns if columns > 1 else k for k in range(len(shown) * columns)]
        stages = [Stage(ax, look, names[k], dict(shown[k].shots.axes)) for ax, k in zip(panels, of_panel, strict=False)]
        for ax in panels[len(stages) :]:
            ax.set_axis_off()
        for k, stage in enumerate(stages):
            stage.label(left=k % across == 0, foot=k >= len(stages) - across)
        fig.colorbar(look.mappable, ax=panels, pad=0.01, shrink=0.9).set_label(look.label)
    return fig, stages


def pictures(fig: Any, stages: list[Any], shown: list[Point], times: np.ndarray, told: Callable[[int, int], None]) -> Any:
    """Every frame as an array of pixels (rows, columns, 3)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from mpm.plots.style import styled

    drawn = FigureCanvasAgg(fig)
    for k, when in enumerate(times):
        for stage, point in zip(stages, shown, strict=True):
            stage.show(nearest(point, when))
        with styled():
            drawn.draw()
        if k == 0:
            fig.set_layout_engine("none")  # panels stand still from now on
        told(k + 1, len(times))
        yield np.asarray(drawn.buffer_rgba())[..., :3].copy()


def write(path: Path, frames: Any, each: float) -> Path:
    """The frames as a file, whole or not at all; `each` is the seconds that one is shown."""
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        if path.suffix.lower() == ".mp4":
            mp4(temporary, frames, each)
        else:
            from PIL import Image

            first, *rest = [Image.fromarray(frame) for frame in frames]
            how = {"quality": 80, "method": 2} if path.suffix.lower() == ".webp" else {"optimize": False}
            first.save(temporary, save_all=True, append_images=rest, duration=max(20, round(1000 * each)), loop=0, **how)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    return path


def mp4(path: Path, frames: Any, each: float) -> None:
    """H.264 by PyAV; even numbers of pixels, as the format wants."""
    try:
        import av
    except ImportError:
        raise MovieError("MP4 needs av: pip install 'mpm[mp4]'; .webp and .gif need nothing more") from None
    from fractions import Fraction

    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=Fraction(1 / each).limit_denominator(1000))
        stream.pix_fmt = "yuv420p"
        for k, pixels in enumerate(frames):
            even = pixels[: pixels.shape[0] // 2 * 2, : pixels.shape[1] // 2 * 2]
            if k == 0:
                stream.height, stream.width = even.shape[:2]
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.ascontiguousarray(even), format="rgb24")))
        container.mux(stream.encode())
