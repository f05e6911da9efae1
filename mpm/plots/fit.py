"""The figure of `mpm fit`: measured curves with the model and its band, residuals, and the profile of each parameter."""

import json
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from mpm.plots import words
from mpm.plots.style import FAINT, INK, OKABE_ITO, QUIET, SMALL, Plain, figure, styled
from mpm.records.variables import describe
from mpm.text import amount

WIDEST = 1.0  # half of a band, over all that model and measurement span: beyond it the band is not drawn


def draw(tree: Any) -> Any:
    """From fit.nc to a figure."""
    root, profile, curves = tree.to_dataset(), tree["profile"].to_dataset(), tree["curves"].to_dataset()
    units = list(dict.fromkeys(str(unit) for unit in root.curve_units.values))
    parameters = len(root.parameter)
    columns = max(3, parameters)
    with styled():
        rows = len(units)
        fig = figure(f"Fit: {tree.attrs['title']}", 3.1 * rows + 2.8)
        grid = fig.add_gridspec(rows + 1, 3 * columns, height_ratios=[1.15] * rows + [1])
        for row, unit in enumerate(units):
            model = fig.add_subplot(grid[row, : 2 * columns])
            left = fig.add_subplot(grid[row, 2 * columns :])
            panel(model, left, root, curves, unit)
        for k in range(parameters):
            ax = fig.add_subplot(grid[rows, k * 3 * columns // parameters : (k + 1) * 3 * columns // parameters])
            valley(ax, root, profile, k)
    return fig


def panel(ax: Any, left: Any, root: Any, curves: Any, unit: str) -> None:
    """Curves of one unit, and their residuals."""
    clock = words.scale(curves.time.values, "s", False)
    numbers = []
    for k, name in enumerate(map(str, root.curve.values)):
        if str(root.curve_units.values[k]) != unit:
            continue
        mine = root.curve_of.values == k
        times, values = root.measured_time.values[mine], root.measured.values[mine]
        scale = words.scale(root.measured.values, unit, words.is_temperature(str(root["variable"].values[k])))
        colour, held = OKABE_ITO[k % len(OKABE_ITO)], bool(root.held_out.values[k])
        said = f"{name}{', held out' if held else ''}: {with_unit(root.misfit.values[k] * scale.factor, scale.units.replace('°C', 'K'), 3)} rms"
        residual = root.residual.values[mine] * scale.factor
        if np.isnan(times).all() or len(times) == 1:
            both = [with_unit(scale(row)[0], scale.units, 4) for row in (values, root.fitted.values[mine])]
            numbers.append(f"{name}{', held out' if held else ''}\nmeasured {both[0]}\nmodel {both[1]}")
            if np.isnan(times).all():
                continue
            said = said.partition(":")[0]
        if f"fitted_{name}" in curves:
            fitted, half = curves[f"fitted_{name}"].values, curves[f"band_{name}"].values
            known = half <= WIDEST * np.ptp([*fitted, *values])  # nor where it is no number
            ax.plot(clock(curves.time.values), scale(fitted), color=colour, lw=1.5)
            ax.fill_between(clock(curves.time.values), scale(fitted - half), scale(fitted + half), known, color=colour, alpha=0.2, lw=0)
            said += "" if known.all() else "; the data leave its band open"
        ax.plot(clock(times), scale(values), "o", ms=4.5, mfc="white" if held else colour, mec=colour, label=said)
        ax.set(xlabel=f"time [{clock.units}]", ylabel=words.wrapped(words.with_units(quantity(str(root["variable"].values[k])), scale.units), 30))
        if len(times) > 1:
            left.plot(clock(times), residual, "o-", ms=3.5, lw=0.8, mfc="white" if held else colour, mec=colour, color=colour)
            left.set(xlabel=f"time [{clock.units}]", ylabel=words.with_units("difference", scale.units.replace("°C", "K")))
    ax.set_title("measured (dots), model with its 95 % band (line)")
    if left.lines:
        left.axhline(0, color=QUIET, lw=0.8)
        left.set_title("model less measurement")
    else:
        left.set_axis_off()
    if ax.get_legend_handles_labels()[0]:
        ax.legend(fontsize=SMALL)
    if not ax.lines:
        ax.set_axis_off()
    if numbers:
        place = left if not left.lines else ax
        place.text(0.02, 0.95, "\n".join(numbers), transform=place.transAxes, va="top", fontsize=SMALL)


def quantity(name: str) -> str:
    """A result in words: `temperature` of every probe, else its long name."""
    if words.is_temperature(name):
        return "temperature"
    try:
        return words.short(describe(name).long_name)
    except KeyError:
        return name.replace("_", " ")


def with_unit(value: float, unit: str, digits: int) -> str:
    """`2.04 K`."""
    return f"{words.number(value, digits)} {unit}".rstrip()


def valley(ax: Any, root: Any, profile: Any, k: int) -> None:
    """The profile of a parameter: rise of the sum of squares, 1 at the ends of the interval."""
    mine = profile.parameter_of.values == k
    value, rise = profile["value"].values[mine], profile.rise.values[mine]
    low, high = root.interval.values[k]
    near = rise <= 4
    best, error = float(root.best.values[k]), float(root.standard_error.values[k])
    lowest, highest = root.interval_covariance.values[k]
    ax.axvspan(low, high, color=FAINT, lw=0, zorder=0)
    x = np.linspace(max(min(low, lowest), min(value[near])), min(max(high, highest), max(value[near])), 100)
    half = (highest - lowest) / 2
    if np.isfinite(half) and half > 0 and half < 20 * (high - low):
        ax.plot(x, ((x - best) / half) ** 2, "--", color=QUIET, lw=1, label="covariance")
    side = np.sign(value - best) * np.sqrt(rise)  # nearly straight, so that a parabola runs through the places
    fine = np.linspace(value.min(), value.max(), 400)
    ax.plot(fine, np.interp(fine, value, side) ** 2, color=OKABE_ITO[0], label="profile")
    ax.plot(value, rise, "o", color=OKABE_ITO[0], ms=4)
    ax.xaxis.set_major_locator(MaxNLocator(4))
    ax.xaxis.set_major_formatter(Plain())
    room = 0.08 * (high - low) or 1.0
    ax.set_xlim(min(low, x[0]) - room, max(high, x[-1]) + room)
    ax.axhline(1, color=QUIET, lw=0.8)
    ax.axvline(best, color=INK, lw=0.8)
    name, unit = str(root.parameter.values[k]), str(root.parameter_units.values[k])
    said = words.called(name)
    long_name = str(root.parameter_long_name.values[k])
    ax.set(xlabel=words.wrapped(words.compose(name, long_name, words.units_text(unit)), 36), ylim=(0, 2.2))
    ax.set_title(f"{said} = {amount(best, error)}")
    if k == 0:
        ax.set_ylabel("rise of the misfit,\n1: end of the 95 % interval")
        ax.legend(fontsize=SMALL)


def sentences(tree: Any) -> list[str]:
    """What the fit says."""
    return json.loads(tree.attrs["sentences"])
