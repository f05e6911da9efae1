"""Implicit mechanics beside explicit steps, error against time: `python -m mpm.benchmarks.implicit [--most SECONDS]`, a table and a picture in docs.

Three scenes at one cell each, so that what is seen is the step's error: the loaf and the viscous disc against implicit steps of FINE of the run, the viscous
column against the stack of material points that it is. Explicit steps at the real time and with time scaled by 50 and 500; what would take longer than
--most is left out, and the table says so. Times are of the process, the second of two runs where the first is short.
Between the two mechanics lies more than the step: explicit runs have no ghost penalty, and their sums differ by what the cell makes (0.1 to 0.3 %).
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np

from mpm.config import load
from mpm.plots import style
from mpm.runner import estimate, run_point, run_points

CONFIGS = Path(__file__).parents[2] / "configs"
DOCS = Path(__file__).parents[2] / "docs"
CASES = {  # config, what is compared, what is changed
    "loaf": (CONFIGS / "scenes" / "loaf_oven_spring.yaml", ("position_max_z", "position_max_r"), {"output.every": "20"}),
    "viscous disc": (CONFIGS / "studies" / "viscous_slump.yaml", ("position_max_z", "position_max_r"), {"output.every": "1"}),
    "viscous column": (CONFIGS / "studies" / "viscous_column.yaml", ("position_mean_x",), {"output.every": "2"}),
}
SETTINGS = {f"implicit, {tolerance:g}": {"method.mechanics_tolerance": str(tolerance)} for tolerance in (1e-3, 3e-4, 1e-4, 3e-5)}
SETTINGS |= {f"explicit, S = {S}": {"method.mechanics": "explicit", "time.scale": str(S)} for S in (1, 50, 500)}
FINE = 1 / 1000
BRIEF = 5.0  # s: what takes less is run twice


def stack(experiment, count: int = 64) -> float:
    """Mean height [m] of a column in one direction whose every slice bears the constant weight of what lies above it: `count` material points."""
    (body,), (material,) = experiment.bodies.values(), experiment.materials.values()
    H, end = body.shape.upper[0], experiment.time.end
    law = {name: getattr(material.flow, name).value for name in ("M", "p0", "eta")}
    elastic = {"hencky": {"E": material.elastic.E.value, "nu": material.elastic.nu}}
    points = [
        load({
            "grid": {"dimension": 0}, "bodies": {"slice": {"shape": "point", "material": "dough"}},
            "materials": {"dough": {"density": material.density, "elastic": elastic, "flow": {"ellipse": law}}},
            "loading": [{"stress": {"xx": material.density * experiment.gravity[0] * H * (1 - (k + 0.5) / count)}}],
            "time": {"end": end, "step": end / 4000}, "output": {"every": end},
        })
        for k in range(count)
    ]  # fmt: skip
    stretch = np.array([run.series["J_min"][-1] for run in run_points(points)])
    return float(np.mean(np.cumsum(stretch) - 0.5 * stretch)) * H / count


def measured(case: str, most: float) -> list[dict]:
    """A row a setting: error [-] and process time [s], or why there is none."""
    file, names, change = CASES[case]
    if case == "viscous column":
        right = {names[0]: stack(load(file))}
    else:
        fine = load(file, change)
        right = run_point(load(file, change | {"time.step": str(FINE * fine.time.end)})).finals
    rows = []
    for setting, more in SETTINGS.items():
        experiment = load(file, change | more)
        if (guess := estimate(experiment)["seconds"]) > most:
            rows.append({"case": case, "setting": setting, "error": "", "seconds": "", "note": f"left out: about {guess:.2g} s"})
            continue
        for _ in range(2):
            before = time.process_time()
            run = run_point(experiment)
            spent = time.process_time() - before
            if spent > 4 * BRIEF:  # with what compiling took, this is no second run of a brief one
                break
        error = max(abs(run.finals[name] / right[name] - 1) for name in names) if run.outcome.ok else ""
        rows.append({"case": case, "setting": setting, "error": error, "seconds": spent, "note": "" if run.outcome.ok else run.outcome.kind})
    return rows


def draw(rows: list[dict], path: Path) -> None:
    """A panel a case: error over time, implicit settings joined."""
    with style.styled():
        fig = style.figure("Implicit mechanics beside explicit steps: error against time", 4.6)
        axes = fig.subplots(1, len(CASES), sharey=True)
        for ax, case in zip(axes, CASES, strict=True):
            ax.set(title=case, xscale="log", yscale="log", xlabel="process time [s]")
            for kind, colour in zip(("implicit", "explicit"), style.OKABE_ITO, strict=False):
                mine = [row for row in rows if row["case"] == case and row["setting"].startswith(kind) and row["error"] != ""]
                ax.plot([row["seconds"] for row in mine], [100 * row["error"] for row in mine], "o-" if kind == "implicit" else "s:", color=colour, label=kind)
                for row in mine:
                    ax.annotate(row["setting"].partition(", ")[2], (row["seconds"], 100 * row["error"]), xytext=(4, 4), textcoords="offset points", fontsize=8)
        axes[0].set_ylabel("largest error of shape [%]")
        axes[0].legend()
        style.save(fig, path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=float, default=600.0, help="seconds from which on a setting is left out")
    rows, most = [], parser.parse_args().most
    for case in CASES:
        rows += measured(case, most)
        for row in rows[-len(SETTINGS) :]:
            print(row, flush=True)
    with (DOCS / "implicit.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, DOCS / "chart_implicit.png")


if __name__ == "__main__":
    main()
