"""Method, cell and step for a tolerance (`mpm plan --tol 1%`): the method from the charted fronts, the cell from pilot runs of the user's own scene.

    choose(experiment, tolerance) -> Choice      offer, settings_in_words: the same for `mpm plan`

1  The kind of physics (rigid heat, heat in particles, mechanics, what bends from a wall, coupled) picks the charts that speak for it (fronts.json: `python -m
   mpm.benchmarks.figures`).
   Of the numerical methods in them, at the automatic step, the one that reaches the tolerance in the least time, over all of those charts, is taken.
2  The cell comes from pilots of the user's own scene (study/pilots.py).
"""

import json
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mpm.config.vary import label
from mpm.scene.bearing import clamped
from mpm.study.pilots import NoChoice, Pilot, refine, silent

FRONTS = Path(__file__).with_name("fronts.json")
NUMERICS = ("grid.basis", "method.", "time.")


@dataclass(frozen=True)
class Choice:
    """What to set, the error that it should have, its seconds a run; from which method of which charts, and the pilots."""

    settings: dict[str, Any]
    predicted: float
    seconds: float
    method: str
    charts: tuple[str, ...]
    pilots: tuple[Pilot, ...] = field(default=())


def physics(experiment: Any) -> str:
    """rigid, heat, mechanics, bending or coupled: which charts speak for a scene."""
    materials = [experiment.materials[body.material] for body in experiment.bodies.values()]
    if not experiment.moving:
        return "rigid"
    warm = any(material.heat is not None for material in materials)
    if warm:
        return "coupled" if any(material.expansion is not None for material in materials) else "heat"
    return "bending" if clamped(experiment) and not any(material.flow is not None for material in materials) else "mechanics"


def numerical(settings: dict[str, Any]) -> dict[str, Any] | None:
    """The numerical part of a method of a chart; None where it is another model (another dimension), which is not ours to choose."""
    if any(path.startswith(("grid.dimension", "bodies")) for path in settings):
        return None
    return {path: value for path, value in settings.items() if path.startswith(NUMERICS)}


def charted() -> list[dict]:
    """The settings of the charts: {study, physics, method, set, cell, steps (none: automatic), error, seconds} (`python -m mpm.benchmarks.figures`)."""
    return json.loads(FRONTS.read_text(encoding="utf-8"))


def rank(kind: str, tolerance: float, fronts: list[dict] | None = None) -> list[tuple[str, dict[str, Any], tuple[str, ...]]]:
    """Methods (name, settings, charts), the cheapest first: by the mean of the logarithms of their time over the best, of those that reach the tolerance."""
    rows = [row for row in (charted() if fronts is None else fronts) if row["physics"] == kind and not row.get("steps")]
    studies = tuple(dict.fromkeys(row["study"] for row in rows))
    found: dict[str, list[float]] = {}
    settings = {json.dumps(row["set"], sort_keys=True): row for row in rows}
    for study in studies:
        times = {key: reach([row for row in rows if row["study"] == study and json.dumps(row["set"], sort_keys=True) == key], tolerance) for key in settings}
        best = min(times.values())
        if math.isinf(best):
            continue  # nothing in this chart gets there: it has no say
        for key, seconds in times.items():
            found.setdefault(key, []).append(math.log(seconds / best))
    order = sorted(found, key=lambda key: sum(found[key]))
    return [(settings[key]["method"], settings[key]["set"], studies) for key in order if math.isfinite(sum(found[key]))]


def reach(rows: list[dict], tolerance: float) -> float:
    """Seconds to a tolerance along one method's settings, interpolated in logarithms; a little beyond the finest too; inf where it is out of reach."""
    rows = sorted((row for row in rows if row["error"] and row["seconds"]), key=lambda row: row["seconds"])
    below = [row for row in rows if row["error"] <= tolerance]
    if below:
        last = below[0]
        before = [row for row in rows if row["seconds"] < last["seconds"]]
        if not before:
            return last["seconds"]
        first = before[-1]
        part = math.log(first["error"] / tolerance) / max(1e-9, math.log(first["error"] / last["error"]))
        return first["seconds"] * (last["seconds"] / first["seconds"]) ** min(1.0, max(0.0, part))
    if len(rows) < 2 or rows[-1]["error"] > 4 * tolerance or rows[-1]["error"] >= rows[-2]["error"]:
        return math.inf
    slope = math.log(rows[-1]["seconds"] / rows[-2]["seconds"]) / math.log(rows[-2]["error"] / rows[-1]["error"])
    return rows[-1]["seconds"] * (rows[-1]["error"] / tolerance) ** slope


def choose(experiment: Any, tolerance: float, fronts: list[dict] | None = None, told: Callable[[str], None] = silent) -> Choice:
    """The cheapest settings that keep `tolerance` (0.01 is 1 %), by the charts and by pilots; NoChoice where there is none. `told` hears of each pilot."""
    if experiment.grid.dimension == 0:
        raise NoChoice("a material point has no cell to choose: take time.step from a chart of its own (mpm chart)")
    kind = physics(experiment)
    ranked = rank(kind, tolerance, fronts)
    if not ranked:
        raise NoChoice(f"no chart of {kind} reaches {100 * tolerance:g} %")
    why_not, began = [], time.process_time()
    for method, settings, charts in ranked[:3]:

        def named(text: str, method: str = method) -> None:
            told(f"{method}, {text}")

        try:
            cell, predicted, seconds, pilots = refine(experiment, settings, tolerance, named, began)
        except NoChoice as why:
            why_not.append(f"{method}: {why}")
            continue
        return Choice(settings | {"grid.cell": cell}, predicted, seconds, method, charts, tuple(pilots))
    hint = "" if experiment.exact is not None else "; `chart.observables` may name fewer quantities that have to keep the tolerance"
    raise NoChoice("; ".join(why_not) + hint)


def offer(experiment: Any, tolerance: float, heard: Callable[[str], None] = silent) -> dict[str, Any]:
    """`choose` as plain data for `mpm plan --tol`: settings, predicted error, seconds and where they come from; or `none`: why not."""
    try:
        found = choose(experiment, tolerance, told=heard)
    except (NoChoice, ValueError) as why:
        return {"tolerance": tolerance, "none": str(why)}
    return {"tolerance": tolerance, "swept": experiment.sweep is not None, **asdict(found)}


def settings_in_words(found: dict[str, Any]) -> str:
    """The same in words, ready to be pasted behind a command."""
    if "none" in found:
        return f"settings  none for {100 * found['tolerance']:g} %: {found['none']}"
    chosen = " ".join(f"--set '{path}={value if isinstance(value, float | int | str) else json.dumps(value)}'" for path, value in found["settings"].items())
    known = [pilot for pilot in found["pilots"] if math.isfinite(pilot["error"])]
    pilots = ", ".join(f"{label(pilot['cell'])} m {100 * pilot['error']:.2g} %" for pilot in known)
    expected = f"error {100 * found['predicted']:.2g} % expected, {found['seconds']:.2g} s a run"
    lines = [f"settings  for {100 * found['tolerance']:g} %: {found['method']}, {expected}"]
    lines += [f"          {chosen}", f"          method from the charts of {', '.join(found['charts'])}; cell from pilots: {pilots}"]
    if found["swept"]:
        lines.append("          for the config's own values, not for each point of its sweep: --set PATH=VALUE plans for the hardest of them")
    return "\n".join(lines)
