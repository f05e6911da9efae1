"""Experiment: one config, validated."""

import functools
import hashlib
import json
import math
from pathlib import Path
from typing import Any

from pydantic import PrivateAttr, model_validator

from mpm.config.base import Kind, Model, doc
from mpm.config.bodies import Body
from mpm.config.boundary import Surface, Wall
from mpm.config.chart import Chart
from mpm.config.contacts import Pair
from mpm.config.fit import Fit
from mpm.config.laws import Constant
from mpm.config.loading import Stage
from mpm.config.loads import Load
from mpm.config.materials import Material
from mpm.config.model import Which
from mpm.config.numerics import Clock, Grid, Method
from mpm.config.output import Exact, Output
from mpm.config.parameters import Named
from mpm.config.programmes import Gravity
from mpm.config.sources import Source
from mpm.config.stability import Stability
from mpm.config.sweep import Sweep
from mpm.config.tools import Tool
from mpm.text import storable

PHYSICS_VERSION = 3
NOT_KEYED = ("title", "sweep", "smoke", "chart", "stability", "parameters", "formulas", "fit")  # cannot change the result of a point


class Experiment(Model):
    """A scene, how it is computed, what is recorded, and what varies. All numbers in SI."""

    title: str = doc("", description="what the experiment asks, for figures and reports")
    grid: Grid = doc(description="dimension, extent and cells of the domain")
    bodies: dict[str, Body] = doc(min_length=1, description="bodies by name")
    materials: dict[str, Material] = doc(min_length=1, description="materials by name")
    surfaces: tuple[Surface, ...] = doc((), description="surfaces that exchange heat")
    sources: tuple[Source, ...] = doc((), description="heat from within bodies, and forces by their mass")
    walls: dict[str, Wall] = doc({}, description="walls of the domain by side; slip unless given")
    contacts: tuple[Pair, ...] = doc((), description="pairs of bodies that meet; those not named slide without friction and conduct without resistance")
    tools: dict[str, Tool] = doc({}, description="rigid bodies that move as they are told, by name")
    gravity: tuple[Gravity, ...] | None = doc(None, description="acceleration of gravity, one entry a direction; each may change over time")
    loads: tuple[Load, ...] = doc((), description="tractions on bodies that move, and drag")
    loading: tuple[Stage, ...] = doc((), description="what is prescribed to a material point (grid.dimension 0), stage by stage")
    time: Clock = doc(description="when the run ends and how it steps")
    method: Method = doc(Method(), description="how the scene is computed; the defaults suit most scenes")
    output: Output = doc(Output(), description="what is recorded, where and how often")
    model: Which | None = doc(None, description="full unless given; auto takes the smallest model that will do")
    exact: Exact | None = doc(None, description="exact solution that the run is compared with")
    sweep: Sweep | None = doc(None, description="what varies")
    chart: Chart | None = doc(None, description="speed against accuracy: methods and resolutions of `mpm chart`")
    stability: Stability | None = doc(None, description="a map of failures, for mpm stability")
    fit: Fit | None = doc(None, description="what `mpm fit` finds from measured curves")
    parameters: dict[str, Named] = doc({}, description="numbers by name, used as `=name` or in formulas wherever a number stands, swept and fitted by name")
    smoke: dict[str, Any] | None = doc(None, description="path: value, applied by --smoke to make the run coarse and short")

    formulas: dict[str, str] = doc({}, description="path: formula over parameters; filled in when the config is read")

    _source: str = PrivateAttr("")
    _path: Path | None = PrivateAttr(None)
    _derived: frozenset[str] = PrivateAttr(frozenset())
    _tree: Any = PrivateAttr(None)  # nodes with places, for errors of points that are planned later

    def __eq__(self, other: object) -> bool:
        """The same data; where it was read from is no difference."""
        return self.__dict__ == other.__dict__ if isinstance(other, Experiment) else NotImplemented

    __hash__ = None  # type: ignore[assignment]  # equal by content, which has no hash

    @model_validator(mode="after")
    def derived(self) -> "Experiment":
        """Defaults that follow from other sections: the cadence of the series, the zeros of the offset."""
        absent = (("every", self.output.every is None), ("offset", not self.method.offset))
        self._derived = frozenset(name for name, derived in absent if derived)
        if self.output.every is None:
            self.__dict__["output"] = self.output.model_copy(update={"every": self.time.end / 100})
        if not self.method.offset:
            self.__dict__["method"] = self.method.model_copy(update={"offset": (0.0,) * self.grid.directions})
        return self

    def _placed(self, like: "Experiment") -> "Experiment":
        """Read from where another was."""
        self._source, self._path, self._tree = like._source, like._path, like._tree
        return self

    @property
    def source(self) -> str:
        """The config's text, verbatim."""
        return self._source

    @property
    def path(self) -> Path | None:
        """The config's file; None for a dict."""
        return self._path

    @property
    def name(self) -> str:
        """The file's stem, or `experiment`."""
        return storable(self._path.stem) if self._path else "experiment"

    @property
    def moving(self) -> bool:
        """Whether any body is elastic, so that there is mechanics at all."""
        return any(self.materials[body.material].elastic is not None for body in self.bodies.values())

    def resolved(self) -> dict[str, Any]:
        """Everything, defaults too, as SI numbers and plain containers; `load` reads it back to the same experiment."""
        return plain(self)

    def key(self) -> dict[str, Any]:
        """What determines a point's result, without defaults: equal for 1, 1.0 and "1000 mm", blind to title, sweep and smoke."""
        sections = {name: self.key_of(name) for name in Experiment.model_fields}
        return {name: data for name, data in sections.items() if data}

    def key_of(self, section: str) -> Any:
        """One section of the key, None if it says nothing; names are sorted where their order means nothing."""
        value = getattr(self, section)
        if section in NOT_KEYED or value is None:
            return None
        data = plain(value, defaults=False)
        if section == "model" and value.kind == "full":
            return None
        if section == "method" and not any(self.method.offset):
            data.pop("offset", None)
        if section == "walls":
            data = {side: wall for side, wall in data.items() if wall != {"slip": {}}}
        if section == "output":
            data.pop("overview", None)  # cannot change the result of a point
        if section == "output" and "probes" in data:
            data["probes"] = dict(sorted(data["probes"].items()))
        return dict(sorted(data.items())) if section in ("materials", "walls") else data

    def key_line(self, section: str) -> str:
        """One section of the key as text."""
        return f"{section} {json.dumps(data, separators=(',', ':'))}\n" if (data := self.key_of(section)) else ""

    def identify(self, known: dict[str, str] | None = None) -> str:
        """Sixteen letters of a hash of the key and the version of the physics; `known` has lines of the key that need not be made again."""
        lines = (known[name] if known and name in known else self.key_line(name) for name in Experiment.model_fields)
        return hashlib.sha256(f"physics {PHYSICS_VERSION}\n{''.join(lines)}".encode()).hexdigest()[:16]

    @property
    def run_id(self) -> str:
        """Sixteen letters that stand for everything that determines the result."""
        return self.identify()

    def template(self) -> dict[str, Any]:
        """The resolved config as one point of a sweep: nothing varies, and derived defaults are left to be derived again."""
        data = plain(self)
        for section, name in (("output", "every"), ("method", "offset")):
            if name in self._derived:
                data[section].pop(name)
        return {**data, "sweep": None, "smoke": None, "chart": None, "stability": None, "fit": None}


@functools.cache
def usual_values(kind: type[Model]) -> dict[str, Any]:
    """The defaults of a model's fields; pydantic makes the mapping of fields anew at every look."""
    return {name: field.default for name, field in kind.model_fields.items()}


def plain(value: Any, defaults: bool = True) -> Any:
    """A model as plain containers: kinds under their name, constants as numbers, infinity as text (JSON has none)."""
    kind: Any = type(value)
    if kind is str or kind is bool or kind is int or value is None:  # most of what a sweep asks for, at every point
        return value
    if isinstance(value, float):
        return value if value != math.inf else ".inf"
    if isinstance(value, Constant):
        return plain(value.value)
    if isinstance(value, Model):
        usual, items = usual_values(kind), vars(value)
        inner = {name: plain(items[name], defaults) for name in usual if defaults or items[name] != usual[name]}
        return {value.kind: inner} if isinstance(value, Kind) else inner
    if isinstance(value, dict):
        return {name: plain(item, defaults) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item, defaults) for item in value]
    return value
