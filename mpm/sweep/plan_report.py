"""What a sweep would do (`mpm plan`): points, what is there already, physics, limits, cost, smaller models. Writes nothing; runs pilots if asked."""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from mpm import compiling
from mpm.config.variation import digits, rounded
from mpm.sweep import engine
from mpm.sweep.api import default_out
from mpm.sweep.case_list import skipped
from mpm.sweep.plan_points import costs, told_together
from mpm.sweep.queue import Points, missing
from mpm.sweep.resources import Resources, size
from mpm.sweep.store import Store


def outlook(
    experiment: Any,
    out: Path | None,
    jobs: int,
    rerun: str | None = None,
    max_runs: int = 10_000,
    tolerance: float | None = None,
    heard: Callable[[str], None] = lambda text: None,
) -> dict[str, Any]:
    """Points and dimensions of the sweep, which are there; of the first that would run `estimate`, groups and smaller models, with pilots at a tolerance; of
    several (`over_points`) what they cost, and the physics of all. `heard` is told of each pilot as it begins."""
    from mpm.scene.groups import groups
    from mpm.sweep.cases import plan as plan_of

    plan = plan_of(experiment, max_runs=max_runs)
    store, points = Store(out or default_out(experiment)), Points.of(plan)
    lines, _ = store.lines(points.ids)
    due = missing(points, lines, rerun)
    first = points.cases[points.ids[due[0]]] if len(due) else plan.cases[0] if plan.cases else None
    cost, over = estimate(first.experiment) if first else {}, {}
    if len(due) > 1 and "seconds" in cost:
        over = costs(points, due, cost)
        cost |= {"physics": told_together(points, due)} if "physics" in cost else {}
    each = cost | over
    explicit = not cost.get("mechanics", "explicit").startswith("implicit")
    step = first.experiment.time.end / cost["steps"] if cost.get("steps") and cost.get("particles") and explicit and first else None
    return {
        "name": experiment.name,
        "title": experiment.title,
        "out": str(store.out),
        "points": points.total,
        "skipped": skipped(plan),
        "distinct": len(points.cases),
        "present": len(points.cases) - len(due),
        "due": len(due),
        "dimensions": [dimension(dim) for dim in plan.dims],
        "estimate": cost,
        "over_points": over,
        "groups": [group.told() for group in groups(first.experiment, step)] if first else [],
        "smaller": smaller(first.experiment, tolerance, heard) if first and "refused" not in cost else None,
        "jobs": jobs,
        "compiling_seconds": compiling.expected(first.experiment) if first else 0.0,
        "seconds": each["seconds"] * len(due) / max(1, min(jobs, len(due))) if "seconds" in each else None,
        "output_bytes": round(each["output_bytes"] * len(due)) if "output_bytes" in each else None,
        "memory_bytes": each["memory_bytes"] * max(1, min(jobs, len(due))) if "memory_bytes" in each else None,
    }


def estimate(experiment: Any) -> dict[str, Any]:
    """What the point will cost; where it needs more memory than is free, only that, as the rest would need it too."""
    room = Resources(Path(), None, far=False)
    if refusal := room.refusal(need := room.need(experiment)):
        return {"refused": f"the point {refusal}: neither steps nor seconds are estimated", "memory_bytes": need}
    return importlib.import_module(engine.RUNNER).estimate(experiment)


def smaller(experiment: Any, tolerance: float | None, heard: Callable[[str], None]) -> dict[str, Any]:
    """Smaller models of one point; with a tolerance pilots are run."""
    from mpm.reduce.listing import listing

    runner = importlib.import_module(engine.RUNNER)

    def run(one: Any) -> Any:
        grid, seconds = one.grid, runner.estimate(one).get("seconds", 0.0)
        moves = "moving" if one.moving else "at rest"
        where = "one temperature" if grid.dimension == 0 else f"{said_dimension(grid.dimension)}, cells of {grid.cell:.3g} m, {moves}"
        heard(f"smaller models, pilot: {where}, {seconds:.2g} s once compiled")
        return runner.run_named(one)

    return listing(experiment, tolerance, run if tolerance is not None else None)


def said_dimension(dimension: int | str) -> str:
    """`2-D`, `axisymmetric`."""
    return dimension if isinstance(dimension, str) else f"{dimension}-D"


def dimension(dim: Any) -> dict[str, Any]:
    """A swept dimension: name, size, and its coordinates' ends."""
    rows = []
    for row in dim.coords:
        ends = {"first": plain(row.values[0]), "last": plain(row.values[-1])}
        if all(isinstance(plain(value), int | float) for value in row.values):
            ends |= {"least": plain(min(row.values)), "most": plain(max(row.values))}
        rows.append({"name": row.name, "config_path": row.config_path, "units": row.units, **ends})
    return {"name": dim.name, "size": dim.size, "coordinates": rows}


def plain(value: Any) -> Any:
    """A numpy scalar as Python's."""
    return value.item() if hasattr(value, "item") else value


def in_words(found: dict[str, Any]) -> str:
    """The same in words."""
    told = [f"{found['name']}: {found['title']}" if found["title"] else found["name"]]
    told.append(f"points    {found['points']}" + (f" ({found['skipped']} dropped by where)" if found["skipped"] else ""))
    told[-1] += f", {found['present']} already in {found['out']}, {found['due']} to run"
    for dim in found["dimensions"]:
        for row in dim["coordinates"]:
            reach = ends(row.get("least", row["first"]), row.get("most", row["last"]))
            units = "" if row["units"] == "1" else row["units"]
            told.append(f"  {dim['name']:<10} {dim['size']:>5} x {row['config_path']}: {reach} {units}".rstrip())
    cost = found["estimate"]
    if refused := cost.get("refused"):
        return "\n".join([*told, refused, *said_groups(found["groups"])])
    if physics := cost.get("physics"):
        told.append(f"compiled  {', '.join(physics['compiled']) or 'nothing'}")
        told.append(f"left out  {', '.join(physics['absent']) or 'nothing'}")
    if limits := cost.get("limits"):
        told.append("step      " + ", ".join(f"{name} {value:.4g} s" for name, value in limits.items()) + f"; {cost.get('binds') or 'none'} binds")
    for name, value in cost.items():
        if name not in ("physics", "limits", "binds", "seconds", "memory_bytes", "output_bytes"):
            told.append(f"{name:<9} {said_value(value)}")
    told += said_groups(found["groups"])
    if found["smaller"]:
        from mpm.reduce.listing import models_in_words

        told += models_in_words(found["smaller"])
    if "seconds" in cost:
        over = found["over_points"] or {"least": cost["seconds"], "most": cost["seconds"], "memory_bytes": cost["memory_bytes"], "refused": []}
        one = f"{cost['seconds']:.3g}" if over["most"] < 1.05 * over["least"] else f"{over['least']:.2g} to {over['most']:.2g}"
        told.append(f"time      {one} s a point, {found['seconds']:.3g} s in all on {found['jobs']} workers (estimates)")
        if found["compiling_seconds"]:
            told.append(f"          not compiled yet: about {found['compiling_seconds']:.0f} s more, once on this machine")
        told.append(f"memory    {size(over['memory_bytes'])} a point    output {size(found['output_bytes'])} in all")
        told += [f"refused   {said}" for said in dict.fromkeys(over["refused"])]
    return "\n".join(told)


def said_groups(groups: list[dict[str, Any]]) -> list[str]:
    """A line for each dimensionless group: value, meaning, what it says could be dropped."""
    several = len({group["body"] for group in groups}) > 1
    lines, names = ["groups"] if groups else [], [f"{group['name']} of {group['body']}" if several else group["name"] for group in groups]
    width = max(map(len, names), default=0)
    for name, group in zip(names, groups, strict=True):
        line = f"  {name:<{width}}  {group['value']:<9.3g} {group['formula']}: {group['meaning']}"
        error = "" if group["error"] is None else f", error about {group['error']:.2g}"
        lines.append(line + (f"; could drop {group['drop']}{error}" if group["drop"] else ""))
    return lines


def ends(first: Any, last: Any) -> str:
    """The ends of an axis, in as many digits as tell them apart; one value alone where both are the same."""
    if first == last:
        return str(first)
    places = digits([value for value in (first, last) if isinstance(value, float)], least=4)
    return " to ".join(rounded(value, places) if isinstance(value, float) else str(value) for value in (first, last))


def short(value: Any) -> str:
    """A number of an estimate."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def said_value(value: Any) -> str:
    """Any further fact of an estimate."""
    if isinstance(value, dict):
        return ", ".join(f"{name} {short(inner)}" for name, inner in value.items())
    return short(value)
