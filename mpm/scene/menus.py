"""What the kinds of a menu of the config are to solvers: one table a family. A kind that its table does not know is refused by name, never left out.

acting(entry)     exchange of one surface entry          pulling(entries)   loads of one body          wall_kind(acts)   a wall of the domain
To add an exchange or a load: a line in its table, and what is new about it in the solvers that `Part.role` names.
"""

from typing import Any, NamedTuple

from mpm.boundary import KINDS
from mpm.config import boundary
from mpm.config import loads as config_loads
from mpm.scene.refusal import SceneError


class Part(NamedTuple):
    """One exchange as every solver takes it: coefficient and what is outside (numbers or programmes of the config)."""

    role: str  # robin: beta (outside - T); flux: q; grey: sigma emissivity (outside^4 - T^4)
    rate: Any  # beta [W/(m2 K)], q [W/m2] or emissivity
    outside: Any = None


EXCHANGE = {
    "convection": lambda one: Part("robin", one.beta, one.outside),
    "fixed": lambda one: Part("robin", float("inf"), one.temperature),
    "flux": lambda one: Part("flux", one.q),
    "radiation": lambda one: Part("grey", one.emissivity, one.surroundings),
}
LOAD = ("traction", "drag")


SECTION = {"exchange": "surfaces", "wall": "walls", "programme": "surfaces", "load": "loads", "law": "materials"}  # of the config, by family


def known(table: Any, kind: str, family: str) -> Any:
    """What a table has for a kind."""
    if kind not in table:
        raise SceneError((SECTION[family],), f"{family} {kind!r} is not known here; what is: {', '.join(table)}")
    return table[kind]


def wall_kind(acts: str) -> int:
    """The number of a wall (mpm.boundary.KINDS) by how it acts."""
    return known(KINDS, acts, "wall")


def acting(entry, role: str = "") -> list[Part]:
    """What a surface entry does, in the order of the table; of one role where told."""
    there = [kind for kind in (*EXCHANGE, *(set(boundary.EXCHANGES) - set(EXCHANGE))) if getattr(entry, kind, None) is not None]
    parts = [known(EXCHANGE, kind, "exchange")(getattr(entry, kind)) for kind in there]
    return [part for part in parts if part.role == role or not role]


def pulling(entries) -> tuple[list, float]:
    """(entries with a traction, rate of the drag) of the loads on one body."""
    for kind in config_loads.LOADS:
        if kind not in LOAD and any(getattr(entry, kind, None) is not None for entry in entries):
            known(dict.fromkeys(LOAD), kind, "load")
    return [entry for entry in entries if entry.traction is not None], float(sum(entry.drag.rate for entry in entries if entry.drag is not None))
