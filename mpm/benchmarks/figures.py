"""The figures of docs/accuracy.md, by one command: `python -m mpm.benchmarks.figures [NAME...]`.

Each configs/studies/<name>.yaml that has a `chart:` is charted into results/<name>-chart (what is there is kept) and its figure goes to docs/chart_<name>.png;
`theory` is docs/theory.png. `--peer NAME=COMMAND` as in `mpm chart`, for those of BESIDE: scikit-fem lives in an environment of its own; `--fem PYTHON` is
short for its P1 and P2 by their program in configs/studies/peers. Stopped anywhere, the same command goes on.
`--quick`: three places a path and two rounds, into results/<name>-chart-quick alone; neither docs/ nor fronts.json change.
"""

import argparse
import json
import math
import shlex
import time
from pathlib import Path

from mpm.records.netcdf import write_whole

ROOT = Path(__file__).parents[2]
STUDIES = ROOT / "configs" / "studies"
DOCS = ROOT / "docs"
BESIDE = {"robin_cylinder": "fem_disc.py", "cantilever": "fem_beam.py", "thermal_shock": "fem_slab.py"}  # charts with scikit-fem beside, and its program


def main() -> None:
    """Make what is named, or all."""
    names = [path.stem for path in sorted(STUDIES.glob("*.yaml")) if "\nchart:" in path.read_text(encoding="utf-8")]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join([*names, *OTHERS])}; all unless given")
    parser.add_argument("--peer", action="append", default=[], metavar="NAME=COMMAND")
    parser.add_argument("--fem", metavar="PYTHON", help="an interpreter that has scikit-fem")
    parser.add_argument("--compiling", action="store_true", help="time compilation too (mpm chart does unless told otherwise)")
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args()
    named = dict(pair.split("=", 1) for pair in given.peer)
    for name in given.names or [*names, *([] if given.quick else OTHERS)]:
        began, peers = time.monotonic(), named if name in BESIDE else {}
        if given.fem and name in BESIDE:
            program = shlex.join([given.fem, str(STUDIES / "peers" / BESIDE[name])])
            peers = named | {"P1": f"{program} 1", "P2": f"{program} 2"}
        for line in OTHERS[name]() if name in OTHERS else charted(name, peers, given.compiling, given.quick):
            print(f"{name}: {line}", flush=True)
        print(f"{name}: {time.monotonic() - began:.0f} s", flush=True)


def small(path: Path) -> None:
    """A picture of a palette, in half of the bytes, for the repository."""
    from PIL import Image  # comes with matplotlib

    with Image.open(path) as picture:
        few = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    few.save(path, optimize=True)


def theory() -> list[str]:
    """docs/theory.png."""
    from mpm.benchmarks.theory import dataset
    from mpm.plots.theory import transfers

    transfers(dataset(), DOCS / "theory.png")
    small(DOCS / "theory.png")
    return [str(DOCS / "theory.png")]


def return_map() -> list[str]:
    """docs/chart_return_map.png."""
    from mpm.benchmarks.return_map import dataset
    from mpm.plots.chart import speed_accuracy
    from mpm.study.front import duration, percent

    data = dataset()
    speed_accuracy(data, DOCS / "chart_return_map.png")
    small(DOCS / "chart_return_map.png")
    rows = zip(data.method.values, data.place.values, data.cpu_min.values, data.relative_error.values, strict=True)
    return [f"{method}, {steps} steps: {duration(seconds)} a state, error {percent(error)}" for method, steps, seconds, error in rows]


OTHERS = {"theory": theory, "return_map": return_map}


def charted(name: str, peers: dict[str, str], cold: bool, quick: bool = False) -> list[str]:
    """The chart of one study, and what it says."""
    import xarray

    from mpm.config import load
    from mpm.plots.chart import speed_accuracy
    from mpm.study.chart import chart, with_chart
    from mpm.sweep.engine import Options

    experiment = with_chart(load(STUDIES / f"{name}.yaml", {"chart.repeats": 2} if quick else {}), quick)
    out = Path("results") / f"{name}-chart{'-quick' if quick else ''}"
    result = chart(experiment, out, Options(), peers=peers, cold=cold)
    if result.stopped:
        raise SystemExit(f"{name}: stopped ({result.stopped}); the same command goes on")
    with xarray.open_dataset(result.dataset, engine="h5netcdf") as data:
        picture = out / "chart.png" if quick else DOCS / f"chart_{name}.png"
        speed_accuracy(data.load(), picture)
        if not quick:
            small(picture)
            if tuple(experiment.chart.error) != ("error_stress",):  # `mpm plan --tol` promises displacement and temperature
                remember(name, experiment, data)
    return result.sentences


def remember(name: str, experiment, data) -> None:
    """The settings with error and time into fronts.json: at the automatic step what `mpm plan --tol` chooses from (study/choose.py); with steps of their own,
    of the model that the config itself names, what benchmarks/promises.py measures that choice by."""
    from mpm.study.choose import FRONTS, numerical, physics
    from mpm.sweep.settings import plan

    kept, seen = [row for row in json.loads(FRONTS.read_text(encoding="utf-8")) if row["study"] != name] if FRONTS.exists() else [], set()
    for case in plan(experiment).cases:
        settings = numerical(experiment.chart.methods[case.values["method"]].set)
        error, seconds = (float(data[key].values[case.flat]) for key in ("relative_error", "cpu_min"))
        steps = {path: value for path, value in case.values.items() if path.startswith(("method.", "time.")) and path not in (settings or {})}
        if settings is None or not math.isfinite(error) or case.run_id in seen or (steps and physics(case.experiment) != physics(experiment)):
            continue
        seen.add(case.run_id)
        row = {"study": name, "physics": physics(case.experiment), "method": case.values["method"], "set": settings}
        kept.append(row | {"cell": case.experiment.grid.cell, "steps": steps, "error": float(f"{error:.4g}"), "seconds": float(f"{seconds:.4g}")})
    rows = ",\n".join(json.dumps(row, ensure_ascii=False) for row in sorted(kept, key=lambda row: row["study"]))
    write_whole(FRONTS, f"[\n{rows}\n]\n".encode())


if __name__ == "__main__":
    main()
