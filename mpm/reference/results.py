"""What a run or a sweep comes to: statuses, outcomes, warnings, exit codes, variables, sides and walls, from the tables that the program itself uses."""

from mpm import outcome, warned
from mpm.config.boundary import SURFACE_SIDES, WALL_SIDES
from mpm.records import variables
from mpm.reference.entry import Entry

VARIABLE = "variable of a dataset"
STATUSES = {
    "ok": "the point ran to its end",
    "failed": "the point could not run: its config, its memory or its program said why",
    "timeout": "the point took longer than --timeout; mpm sweep --rerun failed goes on from its last checkpoint",
    "killed": "the worker process died or was ended again and again, for instance for want of memory",
    "diverged": "the run stopped itself at a guard; `outcome`, `error` and `advice` say which, where and what to do",
    "skipped": "sweep.where left the point out",
    "pending": "the point has not run yet",
}
EXIT_CODES = {
    "0": "all went well (compare: the same)",
    "1": "an internal error, a full disk (compare: different)",
    "2": "usage or config: nothing was written",
    "3": "finished, and some points are not ok; with --strict, some have warnings",
    "4": "every point failed",
    "75": "the time budget was reached; the same command goes on",
    "130": "stopped by Ctrl-C; the same command goes on",
    "141": "all went well, and the reader of the output had left",
    "143": "stopped by SIGTERM or SIGHUP; the same command goes on",
}
GROUPS = {
    variables.POINT: "/ (one number a point)",
    variables.SERIES: "/series (over time)",
    variables.GRID: "/grid (fields, or their coordinates)",
    variables.PARTICLES: "/particles (a column a particle)",
}
PATTERNS = (
    ("temperature_<probe>", "temperature_centre", "output.probes"),
    ("time_to.<probe>.<value>_degC", "time_to.centre.95_degC", "output.observables; the dataset calls it time_to_centre_95_degC; NaN where it is not reached"),
    ("displacement.<probe>_<axis>", "displacement.tip_y", "output.observables"),
    ("stress.<probe>_<part>", "stress.root_xx", "output.observables; parts by dimension: xx, yy, xy; rr, zz, tt, rz; xx, yy, zz, xy, yz, xz"),
    ("force.<wall or tool or pair>_<axis>", "force.bottom_z", "output.observables"),
    ("torque.<wall or tool or pair>_<axis>", "torque.roller_z", "output.observables"),
    ("area.<wall or tool or pair>", "area.press", "output.observables"),
    ("heat.<wall or tool or pair>", "heat.pan", "output.observables; from a hot wall or tool to the bodies, or from the second of a pair to the first"),
    ("measured_temperature_<curve>", "measured_temperature_centre", "output.measured; over measured_time_<curve>"),
    ("misfit_<curve>", "misfit_centre", "output.measured"),
)


def statuses() -> list[Entry]:
    """The values of `status`."""
    return [Entry(name, f"status {code}", STATUSES[name]) for code, name in enumerate(variables.STATUS)]


def outcomes() -> list[Entry]:
    """How a run can end."""
    found = [Entry(kind, "outcome", what or "the run reached time.end", {"advice": advice}) for kind, what, advice in outcome.KINDS.values()]
    return [*found, Entry(variables.MEMORY, "outcome", "the point wants more memory than there is", {"advice": "a coarser grid.cell, or fewer snapshots"})]


def warnings() -> list[Entry]:
    """What is said of runs that ended well."""
    return [
        Entry(kind, "warning", "a run that is ok, with something to know", {"advice": advice, "flag": str(1 << n)}) for n, (kind, advice) in enumerate(KINDS)
    ]


def exit_codes() -> list[Entry]:
    """What a command returns."""
    return [Entry(code, "exit code", said) for code, said in EXIT_CODES.items()]


def observables() -> list[Entry]:
    """All variables of the table, with the observable's name where a config asks for it."""
    asked = {variables.dataset_name(name): name for name in variables.OBSERVABLES}
    made = [
        Entry(
            one.name,
            VARIABLE,
            one.long_name,
            {"unit": one.units, "symbol": one.symbol, "group": GROUPS[one.dims], "asked as": asked.get(name, "")},
        )
        for name, one in variables.VARIABLES.items()
    ]
    return made + [patterned(*row) for row in PATTERNS]


def patterned(pattern: str, one: str, where: str) -> Entry:
    """A variable whose name holds a name of the config."""
    found = variables.describe(variables.dataset_name(one))
    return Entry(pattern, VARIABLE, found.long_name, {"unit": found.units, "group": GROUPS[found.dims], "asked as": where, "example": one})


def sides() -> list[Entry]:
    """Sides of bodies, and walls of the domain."""
    names = list(dict.fromkeys(side for table in (SURFACE_SIDES, WALL_SIDES) for some in table.values() for side in some))
    made = []
    for name in names:
        of_bodies = [str(dimension) for dimension, some in SURFACE_SIDES.items() if name in some]
        of_walls = [str(dimension) for dimension, some in WALL_SIDES.items() if name in some]
        facts = {"surfaces": f"dimension {', '.join(of_bodies)}" if of_bodies else "", "walls": f"dimension {', '.join(of_walls)}" if of_walls else ""}
        made.append(Entry(name, "side", SIDES[name], facts))
    return [*made, Entry("edge 3", "side", SIDES["edge 3"], {"surfaces": "dimension 2, axisymmetric: of a polygon", "walls": ""})]


SIDES = {
    "all": "the whole surface of a body",
    "left": "lowest x",
    "right": "highest x",
    "bottom": "lowest y in the plane, lowest z in axisymmetry and in three dimensions",
    "top": "highest y in the plane, highest z in axisymmetry and in three dimensions",
    "front": "lowest y in three dimensions",
    "back": "highest y in three dimensions",
    "lateral": "round about the axis: all of the surface but bottom and top",
    "inner": "of a body: what faces the axis, along r; in the plane, the hole of a ring",
    "outer": "of the domain: largest r; of a body: what faces away from the axis, along r; in the plane, the rim of a ring",
    "edge 3": "of a polygon: from its third vertex to the next",
}
KINDS = tuple(warned.KINDS.items())
FIELDS = {"grid": variables.FIELDS_GRID, "particles": variables.FIELDS_PARTICLES}
