"""The usual methods and refinements of a chart, by what physics a config has. A config's own `chart:` comes first, then the numerical axes of its sweep."""

import math
from typing import Any

from mpm.config.rules_frame import hindered
from mpm.study.choose import physics
from mpm.study.pilots import extent

NUMERICS = ("grid", "method", "time")
SIZES = ("grid.cell", "time.step")


def usual(experiment: Any) -> dict[str, Any]:
    """{methods, refine} as plain data of config.chart."""
    found = swept(experiment)
    if found is not None:
        return found
    if experiment.grid.dimension == 0:
        step = experiment.time.step if isinstance(experiment.time.step, float) else experiment.output.every
        return {"methods": {"the step": {"set": {}}}, "refine": {"step": {"time.step": [step / 2**k for k in range(5)]}}}
    cells = halvings(experiment)
    if not experiment.moving:
        return {"methods": rigid(), "refine": {"cell": {"grid.cell": cells}}}
    return {"methods": moving(experiment), "refine": paths(experiment, cells)}


def swept(experiment: Any) -> dict[str, Any] | None:
    """From the sweep's own numerical axes, if it has any: cell and step are refined, each product of the others is a method. Other axes stay at their first."""
    if experiment.sweep is None:
        return None
    from mpm.config.vary import label
    from mpm.sweep.cases import plan

    cases = plan(experiment)
    places = {row.config_path: k for k, dim in enumerate(cases.dims) for row in dim.coords if row.config_path.split(".")[0] in NUMERICS}
    if not any(path in places for path in SIZES):
        return None
    used = set(places.values())
    kept = [case for case in cases.cases if not any(index for k, index in enumerate(case.index) if k not in used)]
    methods: dict[str, dict] = {}
    for case in kept:
        own = {path: value for path, value in case.values.items() if path in places and path not in SIZES}
        sizes = {path: value for path, value in case.values.items() if path in SIZES}
        said = ", ".join(f"{path.rsplit('.', 1)[-1]} {label(value)}" for path, value in own.items()) or "as given"
        line = methods.setdefault(said, {"set": own, "refine": {"cell": {path: [] for path in sizes}}})
        for path, value in sizes.items():
            line["refine"]["cell"][path].append(value)
    for line in methods.values():
        (refined,) = line["refine"].values()
        order = sorted(range(len(next(iter(refined.values())))), key=lambda k: tuple(-refined[path][k] for path in refined))
        line["refine"]["cell"] = {path: [values[k] for k in order] for path, values in refined.items()}
    return {"methods": methods, "refine": {}}


def halvings(experiment: Any) -> list[float]:
    """Cells of which the config's own is the third where a body has two of the coarsest, and the domain four: five in one direction, else to half of it."""
    cell, most = experiment.grid.cell, min(min(experiment.grid.size) / 4, extent(experiment) / 2 * (1 + 1e-9))
    first = next((k for k in (2, 1, 0) if cell * 2**k <= most), 0)
    return [cell * 2.0 ** (first - k) for k in range(5 if experiment.grid.directions == 1 else max(3, first + 2))]


def rigid() -> dict[str, dict]:
    """Bodies that do not move."""
    return {
        "implicit, order 4": {"set": {"method.rigid": {"implicit": {"order": 4, "tolerance": 1e-4}}}},
        "implicit, order 4, tolerance 1e-6": {"set": {"method.rigid": {"implicit": {"order": 4, "tolerance": 1e-6}}}},
        "implicit, order 2": {"set": {"method.rigid": {"implicit": {"order": 2, "tolerance": 1e-4}}}},
        "explicit": {"set": {"method.rigid": "explicit"}},
        "bounded": {"set": {"method.rigid": "bounded"}},
    }


def moving(experiment: Any) -> dict[str, dict]:
    """Bodies that move."""
    warm = any(experiment.materials[body.material].heat is not None for body in experiment.bodies.values())
    frame: dict[str, Any] = {} if experiment.method.frame == "updated" else {"method.frame": "updated"}
    both = (lambda kind: frame | {"method.transfer": kind, "method.temperature": kind}) if warm else (lambda kind: frame | {"method.transfer": kind})
    bends = physics(experiment) == "bending" and not hindered(experiment)  # first, so that limits are its own: others go elsewhere (docs/frames.md)
    found = {"total frame": {"set": {"method.frame": "total"}}} if bends else {}
    found |= {
        "APIC": {"set": both("apic")},
        "APIC, B-spline gradient": {"set": both("apic") | {"method.gradient": "bspline"}},
        "APIC, 3 particles": {"set": both("apic") | {"method.particles": 3}},
        "APIC, cubic": {"set": both("apic") | {"grid.basis": "cubic"}},
        "APIC, linear": {"set": both("apic") | {"grid.basis": "linear"}},
        "APIC, float32": {"set": both("apic") | {"method.precision": "float32"}},
        "FLIP": {"set": both("flip")},
        "PIC": {"set": both("pic")},
        "XPIC(2)": {"set": both({"xpic": {"order": 2}})},
    }
    if warm:
        found["affine FLIP"] = {"set": both("affine_flip")}
        found["APIC, implicit heat"] = {"set": both("apic") | {"method.heat": "implicit"}}
    return found


def paths(experiment: Any, cells: list[float]) -> dict[str, dict[str, list[float]]]:
    """h and dt together: Co = const (dt ~ h) and dt* = const (dt ~ h^2), equal at the middle cell. Heat steps where there is heat, else mechanical ones."""
    warm = any(experiment.materials[body.material].heat is not None for body in experiment.bodies.values())
    middle = cells[len(cells) // 2]
    path, step = ("method.heat_step", heat_pace(experiment, middle)) if warm else ("time.step", wave_step(experiment, middle))
    if not math.isfinite(step):
        return {"cell": {"grid.cell": cells}}
    return {
        "Co = const": {"grid.cell": cells, path: [step * cell / middle for cell in cells]},
        "dt* = const": {"grid.cell": cells, path: [step * (cell / middle) ** 2 for cell in cells]},
    }


def heat_pace(experiment: Any, cell: float) -> float:
    """The automatic heat step of a cell [s]."""
    return estimated(experiment, cell).get("heat pace", math.inf)


def wave_step(experiment: Any, cell: float) -> float:
    """The automatic mechanical step of a cell, half of it so that the coarse end of dt ~ h^2 stays stable [s]."""
    limits = estimated(experiment, cell)
    return min((value for name, value in limits.items() if name in ("elastic wave", "advection", "velocity gradient")), default=math.inf) / 4


def estimated(experiment: Any, cell: float) -> dict[str, float]:
    """Limits of the first step with another cell."""
    from mpm.config import load
    from mpm.runner import estimate

    return estimate(load(experiment.template(), {"grid.cell": cell}))["limits"]
