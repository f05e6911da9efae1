"""Speed against accuracy (`mpm chart`): error against time over methods and resolutions, for one config.

    with_chart(experiment) -> experiment     its own `chart:`, else one from its sweep, else the usual methods of its physics (study/menu.py)
    chart(experiment, out, ...) -> Charted   the settings as a sweep (OUT/sweep.nc: errors, outcomes), then rounds of timing, then OUT/chart.nc
Both halves go on where they were interrupted. A setting that fails is a point without an error, with its reason.

Error   of the finals that `chart.error` names, the largest. Relative ones as they are; others over `chart.scale`, those in kelvin unless given over the
        range of temperatures in the most accurate run. Without `exact`: of `chart.observables` against their limit (study/richardson.py), with its own error,
        over `chart.scale` or how much each changes in the run (mpm.reduce.change): positions are measured as displacements.
Time    the smallest of the rounds' processor times of a run, set-up included, without the comparison with the exact solution (study/timing.py)
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpm.records.netcdf import Array, Group, seal, to_bytes, write_whole
from mpm.records.provenance import git_revision, machine, versions
from mpm.records.variables import OK
from mpm.reduce.change import spread
from mpm.study.front import TOLERANCES, cheapest, pareto, sentence
from mpm.study.timing import Timings, compiled, timed
from mpm.sweep.report import Reporter

RELATIVE = ("error_displacement", "error_velocity", "error_stress", "error_temperature", "error_relative", "error_frequency", "error_damping")
DEFAULT = ("error_displacement", "error_relative", "error_l2")
QUICK = 3  # places a path and rounds of a quick chart
KEPT = ("status", "error", "outcome", "run_id", "steps")


@dataclass
class Charted:
    """What a chart came to: its folder, the dataset's path, sentences, counts by status, and why it stopped early."""

    out: Path
    dataset: Path
    sentences: list[str]
    counts: dict[str, int]
    exit_code: int
    stopped: str = ""


def with_chart(experiment: Any, quick: bool = False) -> Any:
    """The experiment with a chart; `quick` keeps the three coarsest places of each path, and three rounds of timing at most."""
    from mpm.config import load
    from mpm.config.experiment import plain
    from mpm.study.menu import usual

    wanted = plain(experiment.chart) if experiment.chart is not None else {}
    if not wanted.get("methods"):
        wanted |= {name: value for name, value in usual(experiment).items() if name == "methods" or not wanted.get(name)}
    if quick:
        wanted["repeats"] = min(QUICK, wanted.get("repeats", QUICK))
        wanted["refine"] = shortened(wanted.get("refine") or {})
        for line in wanted["methods"].values():
            line["refine"] = shortened(line["refine"]) if line.get("refine") else None
    made = load(experiment.template() | {"chart": wanted})
    made._source, made._path = experiment._source, experiment._path
    return made


def shortened(paths: dict[str, dict[str, Any]], most: int = QUICK) -> dict[str, dict[str, Any]]:
    """The first `most` values of each path."""
    return {path: {name: list(values)[:most] for name, values in refined.items()} for path, refined in paths.items()}


def chart(
    experiment: Any, out: Path, options: Any, reporters: Any = Reporter, peers: dict[str, str] | None = None, cold: bool = True, max_runs: int = 10_000
) -> Charted:
    """Run what is missing of a chart and write OUT/chart.nc. `reporters()` makes a reporter for each of the two halves; `cold`: time compiling, too."""
    from mpm.study.timing import Stopped
    from mpm.sweep.api import execute, planned, tree_of
    from mpm.sweep.folder import signals

    result = execute(experiment, out, options, reporters(), max_runs, kind="chart")
    if result.stopped:
        return Charted(out, out / "chart.nc", [], result.counts, result.exit_code, result.stopped)
    plan = planned(experiment, "chart", max_runs)
    tree = tree_of(out / "sweep.nc")
    ok = {case.run_id: case for case in plan.cases if result.lines[case.run_id]["status"] == OK}
    halt: list[str] = []
    reporter, path = reporters(), out / "timing.json"
    try:
        with signals(halt.append):
            labels = {run_id: name(case.values) for run_id, case in ok.items()}
            points = {run_id: case.experiment for run_id, case in ok.items()}
            timings = timed(points, labels, experiment.chart.repeats, path, reporter, peers or {}, lambda: bool(halt))
            if cold:
                timings = compiled({case.values["method"]: case.experiment for case in reversed(ok.values())}, path, reporter, lambda: bool(halt))
    except Stopped:
        return Charted(out, out / "chart.nc", [], result.counts, {"terminated": 143}.get(halt[0], 130), halt[0])
    finally:
        reporter.close()
    variables, said = assemble(experiment, plan, tree, timings)
    attributes = {
        "Conventions": "CF-1.11",
        "title": experiment.title or experiment.name,
        "name": experiment.name,
        "config": experiment.source,
        "config_resolved": experiment.resolved(),
        "answer": "\n".join(said),
        "versions": versions(),
        "git_revision": git_revision(),
        "machine": machine(),
    }
    write_whole(out / "chart.nc", seal(to_bytes({"/": Group(variables)}, attributes), {"settings": len(plan.cases)}))
    return Charted(out, out / "chart.nc", said, result.counts, result.exit_code)


def name(values: dict[str, Any]) -> str:
    """A setting in words: `APIC, cell 0.125, step 0.01`; with the path's name where only the cell is refined along it (`automatic step`)."""
    from mpm.config.vary import label

    numbers = {path.rsplit(".", 1)[-1]: value for path, value in values.items() if isinstance(value, float | int)}
    path = [values["path"]] if set(numbers) == {"cell"} and values["path"] not in ("", "cell") else []
    return ", ".join([values["method"], *(f"{word} {label(value)}" for word, value in numbers.items() if word != "particles"), *path])


def assemble(experiment: Any, plan: Any, tree: Any, timings: Timings) -> tuple[dict[str, Array], list[str]]:
    """The variables of chart.nc, and the answer in sentences."""
    root, rows = tree.to_dataset(), [case.run_id for case in plan.cases]
    rounds = timings.rounds[: experiment.chart.repeats]
    error, largest, about = errors(experiment, tree)
    cpu, wall = (np.array([[one[kind].get(run_id, np.nan) for one in rounds] for run_id in rows]) for kind in ("cpu", "wall"))
    variables = {key: Array(root[key].dims, root[key].values, dict(root[key].attrs)) for key in root.variables if root[key].dims == ("setting",)}
    variables = {key: array for key, array in variables.items() if key in root.coords or key in KEPT or key.startswith("error")}
    names = [name(case.values) for case in plan.cases]
    variables["label"] = Array(("setting",), np.array(names, dtype=object), {"long_name": "setting in words"})
    put = variables.__setitem__
    own = reference_error(experiment, tree)
    put("relative_error", Array(("setting",), error, {"units": "1", "long_name": about, "reference_error": own}))
    if largest is not None:
        put("relative_error_max", Array(("setting",), largest, {"units": "1", "long_name": "largest error, over the same scale"}))
    for kind, data, words in (("cpu", cpu, "processor time"), ("wall", wall, "wall time")):
        put(f"{kind}_time", Array(("setting", "round"), data, {"units": "s", "long_name": f"{words} of a run, set-up included, comparison left out"}))
        put(f"{kind}_min", Array(("setting",), least(data, np.min), {"units": "s", "long_name": f"smallest {words} of the rounds"}))
        put(f"{kind}_median", Array(("setting",), least(data, np.median), {"units": "s", "long_name": f"median {words} of the rounds"}))
    put("load", Array(("round",), np.array([one["load"] for one in rounds]), {"units": "1", "long_name": "load average of the machine as the round began"}))
    put("runs", Array(("setting",), np.array([timings.number.get(run_id, 0) for run_id in rows]), {"units": "1", "long_name": "runs in a timing"}))
    cold = np.array([timings.compiling.get(case.values["method"], np.nan) for case in plan.cases])
    put("compiling", Array(("setting",), cold, {"units": "s", "long_name": "processor time of import, compilation and one run, empty cache, of the method"}))
    ranked = np.where([run_id not in rows[:i] for i, run_id in enumerate(rows)], error, np.nan)  # where two paths meet it is one setting
    front = pareto(ranked, variables["cpu_min"].data)
    put("front", Array(("setting",), front.astype(np.int8), {"units": "1", "long_name": "1 where no other setting has less error in less time"}))
    variables |= peers(rounds, scale_of(experiment, tree))
    least_time, median = variables["cpu_min"].data, variables["cpu_median"].data
    return variables, [sentence(cheapest(ranked, least_time, median, tolerance), names, ranked, least_time, median, own) for tolerance in TOLERANCES]


def least(data: np.ndarray, how: Callable[[np.ndarray], float]) -> np.ndarray:
    """A number a setting from its rounds; NaN where it was not timed."""
    return np.array([how(row[np.isfinite(row)]) if np.isfinite(row).any() else np.nan for row in data])


def peers(rounds: list[dict], scale: float) -> dict[str, Array]:
    """What other programs reached: the smallest and the median time of each of their lines over the rounds."""
    found: dict[tuple[str, int], list[dict]] = {}
    for one in rounds:
        for peer, rows in one["peers"].items():
            for k, row in enumerate(rows):
                found.setdefault((peer, k), []).append(row)
    found = {key: rows for key, rows in found.items() if "failed" not in rows[0]}
    if not found:
        return {}
    seconds = [[row.get("cpu", row["seconds"]) for row in rows if "failed" not in row] for rows in found.values()]
    said = {"long_name": "processor time where the program says it, else wall time", "units": "s"}
    firsts = [rows[0] for rows in found.values()]
    return {
        "peer": Array(("peer_setting",), np.array([first.get("peer", key[0]) for first, key in zip(firsts, found, strict=True)], dtype=object), {}),
        "peer_label": Array(("peer_setting",), np.array([json.dumps({k: v for k, v in first.items() if k != "peer"}) for first in firsts], dtype=object), {}),
        "peer_error": Array(("peer_setting",), np.array([first["error"] for first in firsts]) / scale, {"long_name": "error over the same scale"}),
        "peer_min": Array(("peer_setting",), np.array([min(row) for row in seconds]), said),
        "peer_median": Array(("peer_setting",), np.array([float(np.median(row)) for row in seconds]), said),
    }


def errors(experiment: Any, tree: Any) -> tuple[np.ndarray, np.ndarray | None, str]:
    """(relative error, largest relative error or None, what it is) of every setting."""
    root, wanted = tree.to_dataset(), experiment.chart.error
    if not wanted and experiment.exact is None:
        from mpm.study.richardson import against_limit, observed

        over = "how much each changes in the run" if experiment.chart.scale is None else f"{experiment.chart.scale:.4g}"
        names = [str(root[name].attrs.get("long_name", name)).partition(";")[0] if name in root else name for name in observed(experiment)]
        return against_limit(experiment, tree)[0], None, f"error of {' and '.join(names)} against the Richardson limit, over {over}"
    wanted = wanted_errors(experiment, root.data_vars)
    scale = 1.0 if all(key in RELATIVE for key in wanted) else scale_of(experiment, tree)
    ok = root.status.values == OK
    found = np.max([np.abs(root[key].values) / (1.0 if key in RELATIVE else scale) for key in wanted], axis=0)
    most = root["error_max"].values / scale if wanted == ["error_l2"] else None
    said = joined([root[key].attrs.get("long_name", key) for key in wanted]) + ("" if scale == 1.0 else f", over {scale:.4g}")
    return np.where(ok, found, np.nan), most, said


def joined(texts: list[str]) -> str:
    """Names as one, without what they begin and end with in common: `error of displacement and temperature over its size`."""
    words = [text.split() for text in texts]
    if len(words) < 2:
        return "".join(texts)
    shortest = min(map(len, words))
    alike = lambda places: next((k for k, i in enumerate(places) if len({one[i] for one in words}) > 1), shortest)  # noqa: E731
    head = alike(range(shortest))
    tail = min(alike(range(-1, -shortest - 1, -1)), shortest - head)
    middles = " and ".join(" ".join(one[head : len(one) - tail]) for one in words)
    return " ".join([*words[0][:head], *([middles] if middles.strip(" and") else []), *words[0][len(words[0]) - tail :]])


def wanted_errors(experiment: Any, finals: Any) -> list[str]:
    """The finals that are the error: those that the chart names, else the first of DEFAULT that a run has."""
    named = list(experiment.chart.error) if experiment.chart is not None else []
    wanted = named or next(([key] for key in DEFAULT if key in finals), [])
    missing = [key for key in wanted if key not in finals]
    if missing or not wanted:
        there = ", ".join(key for key in finals if key.startswith("error_"))
        raise ValueError(f"chart.error: no run has {', '.join(missing) or 'an error'}; there are {there or 'none'}")
    return wanted


def scale_of(experiment: Any, tree: Any) -> float:
    """What counts as 100 %."""
    if experiment.chart.scale is not None:
        return experiment.chart.scale
    series, root = tree["series"].to_dataset(), tree.to_dataset()
    if "temperature_max" not in series:
        return 1.0
    row = int(np.nanargmin(root["error_l2"].values)) if "error_l2" in root and np.isfinite(root["error_l2"].values).any() else -1
    return spread({name: series[name].values[row] for name in ("temperature_min", "temperature_max")}) or 1.0


def reference_error(experiment: Any, tree: Any) -> float:
    """The error of the reference itself: zero for an exact solution."""
    if experiment.exact is not None or experiment.chart.error:
        return 0.0
    from mpm.study.richardson import against_limit

    return against_limit(experiment, tree)[1]
