"""Figures of fields: the grid's or the particles' at a few times, at the point that stands for the sweep."""

from typing import Any

import matplotlib
import numpy as np

from mpm.plots import words
from mpm.plots.style import OKABE_ITO, empty, figure, ordered, styled
from mpm.plots.view import View, spread

MOST_TIMES = 4
FIRST = ("temperature", "pressure", "stress_mises", "J", "density")


def snapshot(view: View) -> Any:
    """A field at up to four times: particles where there are any, else the grid's; in 1-D lines, in 3-D the middle slice or the particles of it."""

    with styled():
        for kind, draw in (("particles", particles), ("grid", grid)):
            group = view.groups.get(kind)
            if group is not None and "snapshot" in group.dims and group.sizes["snapshot"]:
                return draw(view, group)
        return empty(view, "The dataset holds no snapshots here (output.snapshots in the config asks for them).")


def canvas(view: View, count: int, aspect: float) -> tuple[Any, np.ndarray]:
    """A row of equal panels."""
    fig = figure(view.title, float(np.clip(10.0 / count * aspect + 1.5, 3.2, 7.0)))
    return fig, fig.subplots(1, count, squeeze=False, sharex=True, sharey=True)[0]


def fields(group: Any) -> str:
    """The field to show."""
    names = [str(name) for name, row in group.data_vars.items() if row.dtype.kind == "f"]
    return next((name for name in FIRST if name in names), next((name for name in names if name not in ("position", "mass")), names[0]))


def stamps(view: View, group: Any) -> tuple[list[int], list[str]]:
    """Which snapshots, and their times in words."""
    times = np.asarray(group["snapshot"].values, dtype=float)
    clock, chosen = words.scale(times, "s"), spread(len(times), MOST_TIMES)
    return chosen, [f"t = {words.number(float(clock(times[i])))} {clock.units}".strip() for i in chosen]


def where(view: View) -> str:
    """The point that is shown."""
    return ", ".join(view.named(view.chosen))


def bar(fig: Any, axes: Any, image: Any, group: Any, name: str, scale: words.Scale) -> None:
    """The colour bar of all panels."""
    label = words.title_case(words.short(str(group[name].attrs.get("long_name", name))))
    fig.colorbar(image, ax=list(axes), pad=0.01, shrink=0.85).set_label(words.with_units(label, scale.units))


def limits(values: np.ndarray) -> dict[str, float]:
    """Colour limits of all times."""
    finite = values[np.isfinite(values)]
    return {"vmin": float(finite.min()), "vmax": float(finite.max())} if finite.size else {"vmin": 0.0, "vmax": 1.0}


def grid(view: View, group: Any) -> Any:
    """A field on the grid."""

    if not group.data_vars or "file" in group.data_vars:
        return empty(view, "The fields of this sweep lie in the files of its points (grid differs from point to point, or fields are large).")
    name = fields(group)
    field = group[name].isel({dim: view.chosen[dim] for dim in view.dims})
    space = [str(dim) for dim in field.dims if dim != "snapshot"]
    if len(space) == 3:
        field = field.isel({space[1]: field.sizes[space[1]] // 2})
        space = [space[0], space[2]]
    chosen, times = stamps(view, group)
    scale = words.scale(field.values, group[name].attrs.get("units", "1"), words.is_temperature(name))
    if len(space) == 1:
        return profile(view, field, space[0], chosen, times, scale, group[name])
    across, up = (np.asarray(field[dim].values, dtype=float) for dim in (space[1], space[0]))
    length = words.scale(np.concatenate([across, up]), "m")
    fig, axes = canvas(view, len(chosen), float(np.ptp(up) / max(np.ptp(across), 1e-300)))
    values = scale(field.transpose("snapshot", *space).values)
    look = {"cmap": matplotlib.colormaps["inferno"], "shading": "nearest", "rasterized": True, **limits(values[chosen])}
    for ax, i, text in zip(axes, chosen, times, strict=True):
        image = ax.pcolormesh(length(across), length(up), values[i], **look)
        ax.set(aspect="equal", xlabel=words.with_units(space[1], length.units))
        ax.set_title(text)
        ax.grid(False)
    axes[0].set_ylabel(words.with_units(space[0], length.units))
    bar(fig, axes, image, group, name, scale)
    fig.supxlabel(where(view), fontsize=9.5)
    return fig


def profile(view: View, field: Any, dim: str, chosen: list[int], times: list[str], scale: words.Scale, source: Any) -> Any:
    """A field along a line, a colour a time."""
    fig = figure(view.title, 4.6)
    ax, x = fig.add_subplot(), np.asarray(field[dim].values, dtype=float)
    length = words.scale(x, "m")
    for i, colour, text in zip(chosen, ordered(len(chosen)) or OKABE_ITO, times, strict=False):
        ax.plot(length(x), scale(field.isel(snapshot=i).values), "-o", ms=3, color=colour, label=text)
    ax.set_xlabel(words.with_units(dim, length.units))
    ax.set_ylabel(words.with_units(words.title_case(words.short(str(source.attrs.get("long_name", source.name)))), scale.units))
    ax.set_title(where(view))
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return fig


def particles(view: View, group: Any) -> Any:
    """Particles, coloured by a field."""

    if "position" not in group:
        return empty(view, "The snapshots hold no positions (add position to output.snapshots.particles).")
    at = {dim: view.chosen[dim] for dim in view.dims}
    starts, sizes = (np.asarray(group[name].isel(at).values) for name in ("row_start", "row_size"))
    chosen, times = stamps(view, group)
    name = fields(group)
    position, field = np.asarray(group["position"].values, dtype=float), np.asarray(group[name].values, dtype=float)
    rows = [slice(starts[i], starts[i] + sizes[i]) for i in chosen]
    points = [np.atleast_2d(position[row].T).T for row in rows]
    values = [field[row] if field.ndim == 1 else np.linalg.norm(field[row], axis=1) for row in rows]
    everything = np.concatenate(points)
    if not everything.size:
        return empty(view, "The chosen point has no particles in its snapshots.")
    flat = everything.shape[1] > 1
    x, y = 0, everything.shape[1] - 1
    letters = "rz" if (view.config.get("grid") or {}).get("dimension") == "axisymmetric" else "xyz"
    length, scale = words.scale(everything, "m"), words.scale(np.concatenate(values), group[name].attrs.get("units", "1"), words.is_temperature(name))
    low, high = length(everything.min(axis=0)), length(everything.max(axis=0))
    fig, axes = canvas(view, len(chosen), float((high[y] - low[y]) / max(high[x] - low[x], 1e-300)) if flat else 0.6)
    look = {"cmap": matplotlib.colormaps["inferno"], "lw": 0, "rasterized": True, **limits(scale(np.concatenate(values)))}
    for ax, place, value, text in zip(axes, points, values, times, strict=True):
        order = np.argsort(-place[:, 1], kind="stable") if everything.shape[1] == 3 else np.arange(len(place))
        size = float(np.clip(9e3 / max(len(place), 1), 1.0, 30.0))
        upward = length(place[order, y]) if flat else scale(value[order])
        image = ax.scatter(length(place[order, x]), upward, c=scale(value[order]), s=size, **look)
        ax.set_title(text)
        ax.margins(0.08)
        ax.set_xlabel(words.with_units(letters[x], length.units))
        if flat:
            ax.set_aspect("equal")
    axes[0].set_ylabel(words.with_units(letters[y], length.units) if flat else words.with_units(name, scale.units))
    bar(fig, axes, image, group, name, scale)
    fig.supxlabel(where(view), fontsize=9.5)
    return fig
