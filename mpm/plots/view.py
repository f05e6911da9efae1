"""What a dataset holds, as figures ask for it: swept axes, observables in order of interest, failures by reason, measured curves."""

import json
from functools import cached_property
from typing import Any

import numpy as np

from mpm.plots import words
from mpm.plots.axis import LOG_RATIO, Axis, spread
from mpm.records.variables import OK, PENDING, SKIPPED, STATUS, dataset_name, describe, threshold
from mpm.text import visible
from mpm.warned import counted

__all__ = ["BOOKKEEPING", "LOG_RATIO", "NOTHING", "Axis", "View", "spread", "tally"]
NOTHING = 1e-12  # of the largest number of a unit
BOOKKEEPING = ("status", "error", "advice", "warnings", "warning_flags", "outcome", "run_id", "steps", "step_shortest", "step_longest", "wall_time",
               "attempts")  # fmt: skip


def tally(reasons: np.ndarray) -> dict[str, int]:
    """How many points have each reason: the commonest first, what is still to run last."""
    names, counts = np.unique([text for text in reasons.ravel() if text], return_counts=True)
    order = sorted(range(len(names)), key=lambda i: (names[i] == STATUS[PENDING], -counts[i]))
    return {str(names[i]): int(counts[i]) for i in order}


class View:
    """A dataset tree as figures see it."""

    def __init__(self, tree: Any):
        self.wanted: str | None = None  # the final that was asked for
        self.along: str | None = None  # the parameter that it is to be drawn over
        self.root = tree.to_dataset()
        self.groups = {name: tree[name].to_dataset() for name in ("series", "grid", "particles") if name in tree.children}
        self.series: Any = self.groups.get("series")  # None in a dataset without series: then there are no `series_names` either
        self.config = json.loads(self.root.attrs.get("config_resolved") or "{}")
        self.dims = tuple(str(dim) for dim in self.root["status"].dims)
        self.sizes = {dim: self.root.sizes[dim] for dim in self.dims}

    @property
    def title(self) -> str:
        """The dataset's title, and whether it is a smoke run."""
        title, name = (str(self.root.attrs.get(key) or "") for key in ("title", "name"))
        title = visible(title if title not in ("", name) else words.title_case((name or "mpm").replace("_", " ")))
        return f"{title} (smoke run: coarse and short)" if str(self.root.attrs.get("smoke", "")).lower() in ("true", "1") else title

    @cached_property
    def own(self) -> list[Axis]:
        """Swept dimensions with values of their own, more than one value each."""
        return [Axis.of(self.root[dim], dim) for dim in self.dims if dim in self.root.coords and self.sizes[dim] > 1]

    @cached_property
    def axes(self) -> list[Axis]:
        """Along what figures are drawn: swept dimensions, and a list of points that differ in words only."""
        return self.own if self.design is None or self.sampled else [*self.own, self.listing()]

    @property
    def along_names(self) -> list[str]:
        """What a result can be drawn over."""
        return [axis.name for axis in (self.parameters if self.sampled else self.axes)]

    def listing(self) -> Axis:
        """A list of points as kinds: what differs in words, else the number of the point."""
        rows = [axis for axis in self.parameters if axis.dim == self.design]
        if len(rows) == 1:
            return rows[0]
        name = str(self.design)
        texts = [", ".join(each) for each in zip(*(axis.values for axis in rows), strict=True)] or [str(i) for i in range(self.sizes[name])]
        return Axis(name, name, np.array(texts, dtype=object), words.title_case(name), name, "", False, True, np.arange(len(texts), dtype=float))

    @cached_property
    def design(self) -> str | None:
        """The dimension of a sample or of a list of points."""
        return next((dim for dim in self.dims if dim not in self.root.coords and self.sizes[dim] > 1), None)

    @cached_property
    def parameters(self) -> list[Axis]:
        """What a sample varies, numbers or else words, then the axes beside it."""
        rows = [row for row in self.root.coords.values() if row.dims == (self.design,) and len(np.unique(row.values)) > 1]
        rows = [row for row in rows if not self.follows.intersection((str(row.name), row.attrs.get("config_path", "")))]
        drawn = [row for row in rows if row.dtype.kind in "fiu"] or rows
        return [Axis.of(row, str(self.design), self.drawn_in_logarithm(row)) for row in drawn] + [axis for axis in self.own if not axis.category]

    @property
    def sampled(self) -> bool:
        """Whether a sample or a list of points varies a number."""
        return any(axis.dim == self.design and not axis.category for axis in self.parameters)

    @cached_property
    def follows(self) -> set[str]:
        """What formulas make of named parameters, and what a sweep derives: they move with the others."""
        formulas = self.config.get("formulas") or {}
        return {*((self.config.get("sweep") or {}).get("derive") or {}), *formulas, *(path.removesuffix(".value") for path in formulas)}

    def named(self, at: dict[str, int]) -> list[str]:
        """A point by its values: what the axes say, and of a sample what its parameters are."""
        words = [axis.says(at[axis.dim]) for axis in self.axes]
        return [*words, *(axis.says(at[axis.dim]) for axis in self.parameters if self.sampled and axis.dim == self.design)]

    @cached_property
    def status(self) -> np.ndarray:
        """Status of every point."""
        return np.asarray(self.root["status"].values)

    @property
    def ok(self) -> np.ndarray:
        """Points that are ok."""
        return self.status == OK

    @cached_property
    def warned(self) -> np.ndarray:
        """Points that are ok and have warnings."""
        return self.ok & (self.root["warning_flags"].values > 0) if "warning_flags" in self.root else np.zeros_like(self.ok)

    def warnings_told(self) -> str:
        """`with warnings (9 points): volume 7, temperature 4`, of a single point their kinds; empty where there are none."""
        if not self.warned.any():
            return ""
        found = self.root["warning_flags"].values[self.warned]
        each = {kind: int(np.count_nonzero(found & (1 << place))) for place, kind in enumerate(self.root["warning_flags"].attrs["flag_meanings"].split())}
        if self.status.size == 1:
            return f"with warnings: {', '.join(kind for kind, count in each.items() if count)}"
        return f"with warnings ({words.counted(len(found), 'point')}): {counted(each)}"

    @cached_property
    def reasons(self) -> np.ndarray:
        """Why a point has no numbers, by point; empty where it is ok or was dropped by `where`."""
        errors = np.broadcast_to(self.root["error"].values if "error" in self.root else np.array(""), self.status.shape)
        found = np.empty(self.status.shape, dtype=object)
        for index, status in np.ndenumerate(self.status):
            bare = status in (OK, SKIPPED) or not 0 <= status < len(STATUS)
            found[index] = "" if bare else STATUS[status] if status == PENDING else words.reason(STATUS[status], str(errors[index]))
        return found

    def counted_reasons(self) -> dict[str, int]:
        """Reasons and how many points have them, the commonest first."""
        return tally(self.reasons)

    @cached_property
    def listed(self) -> list[str]:
        """Dataset names of the observables that the config lists."""
        return [dataset_name(name) for name in (self.config.get("output") or {}).get("observables") or []]

    @cached_property
    def probes(self) -> list[str]:
        """Series of temperatures at probes."""
        names = [f"temperature_{probe}" for probe in (self.config.get("output") or {}).get("probes") or {}]
        if self.series is None:
            return []
        return [name for name in names if name in self.series] or [
            str(name) for name in self.series.data_vars if str(name).startswith("temperature_") and str(name).split("_")[-1] not in ("mean", "min", "max")
        ]

    @property
    def asked(self) -> list[str]:
        """Dataset names of what the config wants in the overview."""
        return [dataset_name(name) for name in (self.config.get("output") or {}).get("overview") or []]

    @property
    def finals(self) -> list[str]:
        """Finals with a number somewhere, the most interesting first: errors, times, what the config lists, probes, the rest."""
        names = [str(name) for name, row in self.root.data_vars.items() if name not in BOOKKEEPING and row.dims == self.dims and row.dtype.kind in "fiu"]
        there = [name for name in names if np.isfinite(self.root[name].values).any()]
        refined = ((self.config.get("sweep") or {}).get("refine") or {}).get("of", "")
        errors = sorted((name for name in there if name.startswith("error_")), key=lambda name: not name.endswith("_l2"))
        first = [*filter(None, [self.wanted, dataset_name(refined)]), *self.asked, *errors, *(name for name in there if name.startswith("time_to_"))]
        wanted = [*first, *self.listed, *self.probes, *there]
        found = [name for name in dict.fromkeys(wanted) if name in there]
        dull = lambda name: name != self.wanted and name not in self.asked and 2 * self.round_off(name) + self.constant(name)  # noqa: E731
        return sorted(found, key=dull)

    @property
    def unreached(self) -> list[str]:
        """Times to a threshold that no point reached, though some are ok."""
        rows = [(str(name), row) for name, row in self.root.data_vars.items() if str(name).startswith("time_to_") and row.dims == self.dims]
        return [name for name, row in rows if self.ok.any() and not np.isfinite(row.values).any()]

    def constant(self, name: str) -> bool:
        """Whether several points have the same number, to a part in a million."""
        values = self.root[name].values[np.isfinite(self.root[name].values)]
        return bool(len(values) > 1 and np.ptp(values) <= 1e-6 * np.abs(values).max())

    def round_off(self, name: str) -> bool:
        """Whether a final is round-off: an error of the digits themselves, books that are right, or the kinetic energy of what has come to rest."""
        units, values = self.root[name].attrs.get("units", "1"), np.nanmax(np.abs(self.root[name].values), initial=0.0)
        most, whole = 0.0, self.largest(units)
        if name.startswith("error_"):
            return bool(values < 1e-13 * max(whole, float(units == "1")))  # one without a unit is a share
        if name.endswith("_ledger"):
            return bool(values < 1e-9 * whole)
        if self.series is not None and name in self.series and name.startswith(("energy", "momentum", "velocity")):
            most = max(np.nanmax(np.abs(self.series[name].values), initial=0.0), 1e-6 * whole)
        return bool(values < max(1e-9 * most, NOTHING * whole, NOTHING * (units == "Pa")))

    def largest(self, units: str) -> float:
        """The largest number of all series of a unit."""
        if self.series is None:
            return 0.0
        rows = [row.values for row in self.series.data_vars.values() if "time" in row.dims and row.attrs.get("units", "1") == units and row.dtype.kind == "f"]
        return max((float(np.nanmax(np.abs(row), initial=0.0)) for row in rows), default=0.0)

    def label(self, name: str, units: str) -> str:
        """The axis label of a variable in the units shown."""
        return words.with_units(words.title_case(words.short(self.long_name(name))), units)

    def long_name(self, name: str) -> str:
        """The long name that the dataset gives, else that of the table of variables."""
        for group in (self.root, self.series):
            if group is not None and name in group and group[name].attrs.get("long_name"):
                return str(group[name].attrs["long_name"])
        try:
            return describe(name).long_name
        except KeyError:
            return name.replace("_", " ")

    def scale(self, name: str, group: Any = None) -> words.Scale:
        """How to show a variable."""
        row = (self.root if group is None else group)[name]
        return words.scale(row.values, row.attrs.get("units", "1"), words.is_temperature(name))

    def thresholds(self, probe: str) -> list[tuple[str, float]]:
        """Finals `time_to_<probe>_...` of a probe's series, each with its temperature in degrees Celsius."""
        probes = (self.config.get("output") or {}).get("probes") or {}
        found = [(str(name), threshold(str(name), probes)) for name in self.root.data_vars]
        return [(name, row.kelvin - words.KELVIN) for name, row in found if row is not None and f"temperature_{row.probe}" == probe]

    def measured(self, name: str) -> tuple[np.ndarray, np.ndarray, str] | None:
        """Times [s], values and source of the measured curve of a series; None where there is none."""
        row = None if self.series is None else self.series.get(f"measured_{name}")
        if row is None or row.ndim != 1:
            return None
        times, values = np.asarray(self.series[row.dims[0]].values, dtype=float), np.asarray(row.values, dtype=float)
        known = np.isfinite(times) & np.isfinite(values)
        return (times[known], values[known], str(row.attrs.get("source", ""))) if known.any() else None

    def misfit(self, name: str) -> np.ndarray | None:
        """Root-mean-square difference of a probe's series from its measured curve, by point; None where the dataset has none."""
        row = self.root.get(f"misfit_{name.removeprefix('temperature_')}")
        return None if row is None or row.dims != self.dims else np.asarray(row.values, dtype=float)

    @cached_property
    def chosen(self) -> dict[str, int]:
        """The point that stands for the sweep: nearest to the measured curves, else the middle, moved to the nearest point that is ok."""
        fits = [fit for fit in (self.misfit(name) for name in self.series_names()) if fit is not None]
        if fits:
            total = np.sqrt(np.mean(np.square(fits), axis=0))
            if np.isfinite(total).any():
                return dict(zip(self.dims, map(int, np.unravel_index(np.nanargmin(total), total.shape)), strict=True))
        middle = np.array([(size - 1) // 2 for size in self.sizes.values()])
        candidates = np.argwhere(self.ok)
        if len(candidates):
            middle = candidates[np.argmin(np.abs(candidates - middle).sum(axis=1))]
        return dict(zip(self.dims, map(int, middle), strict=True))

    def drawn_in_logarithm(self, row: Any) -> bool | None:
        """Whether the config draws a sampled parameter from a logarithmic range; None where it does not say."""
        sample = (self.config.get("sweep") or {}).get("sample") or {}
        ranges = {name: span for design in sample.values() if design for name, span in design["ranges"].items()}
        name = str(row.name)
        spans = [ranges[key] for key in (name, words.symbol(name), row.attrs.get("config_path")) if key in ranges]
        return isinstance(spans[0], dict) and "log" in spans[0] if spans else None

    def series_names(self) -> list[str]:
        """Series with a number somewhere: what the overview asks for, probes, what the config lists; else errors, then the others that change."""
        if self.series is None:
            return []
        there = [str(name) for name, row in self.series.data_vars.items() if "time" in row.dims and np.isfinite(row.values).any()]
        wanted = [name for name in dict.fromkeys([*self.asked, *self.probes, *self.listed]) if name in there]
        return wanted or sorted((name for name in there if self.changes(name)), key=lambda name: not name.startswith("error_")) or there

    def changes(self, name: str) -> bool:
        """Whether a series changes with time by more than round-off."""
        values, units = self.series[name].values[np.isfinite(self.series[name].values)], self.series[name].attrs.get("units", "1")
        return bool(np.ptp(values) > max(1e-6 * np.abs(values).max(), 1e-9 * self.largest(units), 1e-6 * (units == "Pa")))

    def kin(self, name: str) -> tuple[str, str]:
        """Family and unit of a series."""
        return name.split("_", maxsplit=1)[0], self.series[name].attrs.get("units", "1")

    def told(self, name: str) -> bool:
        """Whether a series is anything beside the others of its unit; a momentum, beside that of the whole mass at the largest speed."""
        most = {one: float(np.nanmax(np.abs(self.series[one].values), initial=0.0)) for one in (name, "mass_total", "velocity_max") if one in self.series}
        whole = most.get("mass_total", 0.0) * most.get("velocity_max", 0.0) if name.startswith("momentum") else 0.0
        return most[name] > NOTHING * max(whole, self.largest(self.series[name].attrs.get("units", "1")))

    def families(self) -> list[list[str]]:
        """Series that share a panel: of one family and one unit, as energies or temperatures do; without those that are nothing, if others are not."""
        found: dict[tuple[str, str], list[str]] = {}
        for name in self.series_names():
            found.setdefault(self.kin(name), []).append(name)
        return [names for names in found.values() if any(self.told(name) for name in names) and not self.unkept(names)] or list(found.values())

    def unkept(self, names: list[str]) -> bool:
        """Whether the books of a family miss about what they hold, in a run that is not warned of: both are round-off."""
        sizes = {name: float(np.nanmax(np.abs(self.series[name].values), initial=0.0)) for name in names}
        return not self.warned.any() and max((size for name, size in sizes.items() if name.endswith("_ledger")), default=0.0) > 0.1 * max(sizes.values())
