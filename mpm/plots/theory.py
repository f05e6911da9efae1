"""The figure of `mpm.benchmarks.theory`: what transfers do by themselves, measured, beside the line of theory."""

from pathlib import Path
from typing import Any

import numpy as np

from mpm.plots.style import INK, OKABE_ITO, QUIET, figure, save, styled


def transfers(data: Any, path: Path | str | None = None) -> Any:
    """Three panels from the dataset of `mpm.benchmarks.theory.dataset`; to a file where a path is given."""
    with styled():
        fig = figure("What transfers do by themselves: measured (marks), theory (lines)", 4.2)
        left, middle, right = fig.subplots(1, 3)
        for ax, x, measured, theory, words in (
            (left, "dt", "fake", "fake_theory", ("heat step [s]", "conductivity that is not there [W/m/K]")),
            (middle, "kh", "loss", "loss_theory", ("wave number times cell", "loss of amplitude a step")),
        ):
            ax.loglog(data[x], data[theory], color=INK, lw=1.4, label=data[theory].attrs["long_name"])
            ax.loglog(data[x], data[measured], "o", color=OKABE_ITO[0], ms=6, mec="white", label="measured")
            ax.set_xlabel(words[0])
            ax.set_ylabel(words[1])
            ax.legend()
        left.set_title("PIC of temperature")
        middle.set_title("APIC of temperature")
        for k, basis in enumerate(data["basis"].values):
            error = data["error"].sel(basis=basis)
            right.loglog(data["cells"], error, "-o", color=OKABE_ITO[k + 1], ms=6, mec="white", label=str(basis))
            for n in data["cells"].values[~np.isfinite(error.values)]:
                right.plot(n, 0.5, "x", color=OKABE_ITO[k + 1], mew=1.8)
        cells = data["cells"].values.astype(float)
        right.loglog(cells, 0.2 * float(data["error"].sel(basis="quadratic")[0]) * (cells / cells[0]) ** -2, color=QUIET, lw=1, ls=":", label="second order")
        right.set_xlabel("cells")
        right.set_ylabel("relative error of displacement (x: failed)")
        right.set_title("Bases at a strain of 0.31")
        right.set_xticks(cells, [f"{n:g}" for n in cells])
        right.minorticks_off()
        right.legend()
        if path is not None:
            save(fig, path)
    return fig
