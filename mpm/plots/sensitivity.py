"""The figure of `mpm sensitivity`: indices of each observable with their intervals, and the share that failed along each parameter."""

from typing import Any

import numpy as np

from mpm.plots import words
from mpm.plots.style import INK, OKABE_ITO, QUIET, SMALL, figure, styled

MOST = 6


def draw(found: Any) -> Any:
    """From sensitivity.nc to a figure."""
    names, observables = list(map(str, found.parameter.values)), list(map(str, found.observable.values))[:MOST]
    failing = bool((found.failed.values > 0).any())
    with styled():
        columns = min(3, len(observables) + failing)
        rows = -(-(len(observables) + failing) // columns)
        fig = figure(f"Sensitivity: {found.attrs['title']}", 1.2 + rows * (1.3 + 0.42 * len(names)))
        axes = fig.subplots(rows, columns, squeeze=False).ravel()
        for ax in axes[len(observables) + failing :]:
            ax.set_axis_off()
        for k, ax in enumerate(axes[: len(observables)]):
            bars(ax, found, k, names)
            late = int(found.unreached.values[k])
            censored = f"\nnot reached at {late} of {int(found.known.values[k])} points" if late else ""
            ax.set_title(words.wrapped(str(found.observable_long_name.values[k]), 34) + censored)
        if failing:
            thirds(axes[len(observables)], found, names)
        shown = {label: handle for ax in axes for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)}
        fig.legend(shown.values(), shown, loc="outside lower center", ncols=len(shown), fontsize=SMALL)
    return fig


def said_of(name: str) -> str:
    """A parameter's symbol, else its name."""
    return words.symbol(name) or name.replace("_", " ")


def bars(ax: Any, found: Any, k: int, names: list[str]) -> None:
    """One observable: total behind first, or rank correlations where there are no indices."""
    kinds = [kind for kind in ("total", "first") if np.isfinite(found[kind].values[k]).any()] or ["spearman"]
    said = {"total": "total index", "first": "first-order index", "spearman": "rank correlation"}
    y = np.arange(len(names))
    for place, kind in enumerate(kinds):
        value, low, high = np.clip(found[kind].values[k].T, -1 if kind == "spearman" else 0, 1)
        at = y + (place - (len(kinds) - 1) / 2) * 0.36
        colour = OKABE_ITO[{"first": 0, "total": 4, "spearman": 2}[kind]]
        ax.barh(at, value, 0.34, color=colour, label=said[kind])
        ax.errorbar(value, at, xerr=[np.maximum(value - low, 0), np.maximum(high - value, 0)], fmt="none", ecolor=INK, elinewidth=1, capsize=3)
    ax.axvline(0, color=QUIET, lw=0.8)
    ax.set_yticks(y, list(map(said_of, names)))
    ax.set_xlim(-1.05 if kinds == ["spearman"] else -0.05, 1.05)
    ax.invert_yaxis()


def thirds(ax: Any, found: Any, names: list[str]) -> None:
    """Share that failed in the thirds of each range."""
    y = np.arange(len(names))
    for t, said in enumerate(("failed in the lower third", "middle third", "upper third")):
        ax.barh(y + (t - 1) * 0.26, 100 * found.failed.values[:, t], 0.24, color=OKABE_ITO[1], alpha=(0.35, 0.65, 1.0)[t], label=said)
    chance = ["" if p < 0.01 else "\n(by chance)" for p in found.failed_p.values]
    ax.set_yticks(y, [said_of(name) + more for name, more in zip(names, chance, strict=True)])
    ax.set(title=f"failed, {100 * float(found.attrs['share_failed']):.0f} % of {int(found.attrs['points'])} points", xlabel="[%]")
    ax.invert_yaxis()
