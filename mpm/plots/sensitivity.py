"""The figure of `mpm sensitivity`: indices of each observable with their intervals, and the share that failed, or did not reach it, along each parameter."""

from typing import Any

import numpy as np

from mpm.plots import words
from mpm.plots.style import INK, OKABE_ITO, QUIET, SMALL, figure, styled

MOST_OBSERVABLES = 6


def draw(found: Any) -> Any:
    """From sensitivity.nc to a figure."""
    names, observables = list(map(str, found.parameter.values)), list(map(str, found.observable.values))[:MOST_OBSERVABLES]
    panels = [(f"failed, {100 * float(found.attrs['share_failed']):.0f} % of {int(found.attrs['points'])} points", found.failed.values, found.failed_p.values)]
    for k in range(len(observables)):
        title = words.wrapped(
            f"{found.observable_long_name.values[k]}: not reached, {100 * found.unreached.values[k] / found.known.values[k]:.0f} % of points", 34
        )
        panels.append((title, found.unreached_share.values[k], found.unreached_p.values[k]))
    panels = [panel for panel in panels if (panel[1] > 0).any()]
    with styled():
        columns = min(3, len(observables) + len(panels))
        rows = -(-(len(observables) + len(panels)) // columns)
        fig = figure(f"Sensitivity: {found.attrs['title']}", 1.2 + rows * (1.3 + 0.42 * len(names)))
        axes = fig.subplots(rows, columns, squeeze=False).ravel()
        for ax in axes[len(observables) + len(panels) :]:
            ax.set_axis_off()
        for k, ax in enumerate(axes[: len(observables)]):
            bars(ax, found, k, names)
            late = int(found.unreached.values[k])
            censored = f"\nnot reached at {late} of {int(found.known.values[k])} points" if late else ""
            ax.set_title(words.wrapped(str(found.observable_long_name.values[k]), 34) + censored)
        for ax, panel in zip(axes[len(observables) :], panels, strict=False):
            thirds(ax, names, *panel)
        shown = {label: handle for ax in axes for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)}
        fig.legend(shown.values(), shown, loc="outside lower center", ncols=len(shown), fontsize=SMALL)
    return fig


def said_of(name: str) -> str:
    """A parameter's symbol, else its name."""
    return words.called(name)


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


def thirds(ax: Any, names: list[str], title: str, shares: np.ndarray, p: np.ndarray) -> None:
    """Share that failed, or did not reach it, in the thirds of each range."""
    y = np.arange(len(names))
    for t, said in enumerate(("share in the lower third of the range", "middle third", "upper third")):
        ax.barh(y + (t - 1) * 0.26, 100 * shares[:, t], 0.24, color=OKABE_ITO[1], alpha=(0.35, 0.65, 1.0)[t], label=said)
    ax.set_yticks(y, [said_of(name) + ("" if chance < 0.01 else "\n(by chance)") for name, chance in zip(names, p, strict=True)])
    ax.set(title=title, xlabel="[%]", xlim=(0, 100))
    ax.invert_yaxis()
