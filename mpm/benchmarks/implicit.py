"""Implicit mechanics beside explicit steps, error against time: `python -m mpm.benchmarks.implicit [CASE ...] [--most SECONDS]`, a table and a picture in docs.

Three scenes at one cell each, so that what is seen is the step's error: the loaf and the viscous disc against implicit steps of FINE of the run, the viscous
column against the stack of material points that it is. Explicit steps at the real time and with time scaled by 50 and 500; what would take longer than
--most is left out, and the table says so. Times are of the process, the least of ROUNDS through all settings, so that what else a machine does meets all alike;
what takes more than BRIEF is run once. A case that is named is measured again, the rows of the others stay.
Between the two mechanics lies more than the step: explicit runs have no ghost penalty, and their sums differ by what the cell makes (0.1 to 0.3 %).
"""

import argparse
import csv
import math
import time
from pathlib import Path

import numpy as np

from mpm.config import load
from mpm.plots import style
from mpm.runner import estimate, run_point, run_points

CONFIGS = Path(__file__).parents[2] / "configs"
DOCS = Path(__file__).parents[2] / "docs"
CASES = {  # config, what is compared, what is changed: no output on the way, where every step would end
    "loaf": (CONFIGS / "scenes" / "loaf_oven_spring.yaml", ("position_max_z", "position_max_r"), {"output.every": "240"}),
    "viscous disc": (CONFIGS / "studies" / "viscous_slump.yaml", ("position_max_z", "position_max_r"), {"output.every": "10"}),
    "viscous column": (CONFIGS / "studies" / "viscous_column.yaml", ("position_mean_x",), {"output.every": "20"}),
}
SETTINGS = {f"implicit, {tolerance:g}": {"method.mechanics_tolerance": str(tolerance)} for tolerance in (1e-3, 3e-4, 1e-4, 3e-5)}
SETTINGS |= {f"explicit, S = {S}": {"method.mechanics": "explicit", "time.scale": str(S)} for S in (500, 50, 1)}
KINDS = {"implicit": "implicit, by tolerance", "explicit": "explicit, time scaled by S"}
FINE = 1 / 500
BRIEF, ROUNDS = 20.0, 3


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
    rows: dict[str, dict] = {setting: {"case": case, "setting": setting, "error": "", "seconds": "", "note": ""} for setting in SETTINGS}
    spent = dict.fromkeys(SETTINGS, math.inf)
    for turn in range(ROUNDS):
        for setting, row in rows.items():
            experiment = load(file, change | SETTINGS[setting])
            if (guess := estimate(experiment)["seconds"]) > most:
                row["note"] = f"left out: about {guess:.2g} s"
            if row["note"] or (turn and guess > BRIEF):
                continue
            before = time.process_time()
            run = run_point(experiment)
            spent[setting] = min(spent[setting], time.process_time() - before)
            if not run.outcome.ok:
                row["note"] = run.outcome.kind
                continue
            row |= {"error": max(abs(run.finals[name] / right[name] - 1) for name in names), "seconds": spent[setting]}
            print(row, flush=True)
    return list(rows.values())


def draw(rows: list[dict], path: Path) -> None:
    """A panel a case that was measured: error over time, settings of a kind joined."""
    cases = [case for case in CASES if any(row["case"] == case for row in rows)]
    with style.styled():
        fig = style.figure("Implicit mechanics beside explicit steps: error against time", 4.6)
        axes = fig.subplots(1, len(cases), sharey=True, squeeze=False)[0]
        labels = []
        for ax, case in zip(axes, cases, strict=True):
            ax.set(title=case, xscale="log", yscale="log", xlabel="processor time [s]")
            ax.margins(x=0.12)
            for (kind, words), colour in zip(KINDS.items(), style.OKABE_ITO, strict=False):
                mine = [row for row in rows if row["case"] == case and row["setting"].startswith(kind) and row["error"] != ""]
                places = [(row["seconds"], 100 * row["error"]) for row in mine]
                ax.plot(*np.reshape(places, (-1, 2)).T, "o-" if kind == "implicit" else "s:", color=colour, label=words)
                told = slice(None, None, 1 if kind == "explicit" else max(len(mine) - 1, 1))  # tolerances stand close: the ends of their line
                labels += [(ax, row["setting"].partition(", ")[2], *place) for row, place in zip(mine[told], places[told], strict=True)]
        taken: dict = {ax: [] for ax in axes}  # by labels
        fig.draw_without_rendering()  # lays panels out: now all limits are known
        for ax, *label in labels:
            taken[ax].append(beside(ax, taken[ax], *label))
        axes[0].set_ylabel("largest error of shape [%]")
        axes[0].legend()
        style.save(fig, path)


def beside(ax, taken: list[np.ndarray], text: str, x: float, y: float) -> np.ndarray:
    """A label at a point, in that of four places where it lies on the least of what is drawn, sides of the frame and labels too; points that fill it."""
    lines = [ax.transData.transform(line.get_xydata()) for line in ax.lines if len(line.get_xydata())]
    lines += [ax.transAxes.transform([(side, 0), (side, 1)]) for side in (0, 1)]
    dense = [np.array([np.interp(np.linspace(0, len(one) - 1, 400), np.arange(len(one)), side) for side in one.T]).T for one in lines]
    here, point, (wide, high) = ax.transData.transform((x, y)), ax.figure.dpi / 72, (5.5 * len(text) + 8, 15)
    away = (np.concatenate([*dense, *taken]) - here) / point
    right, up = min(((right, up) for up in (1, -1) for right in (1, -1)), key=lambda to: np.sum(np.all((away * to > 1) & (away * to < (wide, high)), axis=1)))
    ax.annotate(text, (x, y), xytext=(5 * right, 5 * up), textcoords="offset points", fontsize=8, ha="left" if right > 0 else "right",
                va="bottom" if up > 0 else "top")  # fmt: skip
    return here + point * np.stack(np.meshgrid(np.linspace(0, wide, 40) * right, np.linspace(0, high, 20) * up), axis=-1).reshape(-1, 2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"{', '.join(CASES)}; all unless said")
    parser.add_argument("--most", type=float, default=600.0, help="seconds from which on a setting is left out")
    given, table = parser.parse_args(), DOCS / "implicit.csv"
    rows: list[dict] = []
    again = given.cases or list(CASES)
    if unknown := set(again) - set(CASES):
        parser.error(f"no case {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    if table.exists():
        with table.open(newline="", encoding="utf-8") as file:
            rows = [row | {name: float(row[name]) for name in ("error", "seconds") if row[name]} for row in csv.DictReader(file)]
    for case in again:
        rows = [row for row in rows if row["case"] != case] + measured(case, given.most)
        rows.sort(key=lambda row: list(CASES).index(row["case"]))
        with table.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
    draw(rows, DOCS / "chart_implicit.png")


if __name__ == "__main__":
    main()
