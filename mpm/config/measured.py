"""Measured curves: a CSV beside the config, read when the config is (config.curves), so that a point carries its data and no path.

A curve belongs to a probe of its name, or to the observable that `of` names. Its column's unit stands in the header (`centre_degC`, `Height [mm]`), or is
`unit`. A single number is a curve too: `{of: radius.99, samples: [[3 s, 62.8 mm]]}`, or `equals` for what is one number a run (`time_to.centre.95_degC`).
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import model_validator

from mpm.config.base import Model, doc
from mpm.config.curves import read
from mpm.config.explain import Finding
from mpm.config.headers import Unreadable
from mpm.config.problems import brief, near
from mpm.config.quantities import Number, Positive, Quantity


class Measured(Model):
    """A measured curve."""

    file: str = doc("", description="CSV file, relative to the config")
    of: str | None = doc(None, description="the observable or probe that was measured; the probe of the curve's name unless given")
    time: str = doc("", description="column of the time; its name tells the unit, clock times count from the first row")
    value: str = doc("", description="column of the value; its name tells the unit, as height_mm, oven_degF, T [°C] (T will do); the only one unless given")
    unit: str = doc("", description="unit of the column, where its name tells none")
    start: float | str | None = doc(None, description="what the time column shows as the run begins; rows before are left out")
    sigma: float | str | None = doc(None, description="standard error of the values: a number, text with a unit, or the name of a column")
    weight: Positive = doc(1.0, description="how much the curve counts in a fit; its squares are multiplied by this")
    equals: float | str | None = doc(None, description="the measured value of an observable that is one number a run, as time_to.centre.95_degC")
    samples: tuple[tuple[Any, ...], ...] = doc((), description="[time, value] or [time, value, sigma]; filled in from the file when the config is read")
    units: str = doc("", description="SI unit of the samples; filled in when the config is read")

    @model_validator(mode="after")
    def plain(self) -> "Measured":
        """Samples that are SI numbers already, as floats."""
        if self.units:
            self.__dict__["samples"] = tuple(tuple(float(item) for item in row) for row in self.samples)
            for name in ("equals", "sigma"):
                value = getattr(self, name)
                if isinstance(value, int) and not isinstance(value, bool):
                    self.__dict__[name] = float(value)
        return self


def target(experiment: Any, name: str, curve: Measured) -> tuple[str, str] | None:
    """(name in the dataset, SI unit) of what a curve measures; None where the config records no such thing."""
    from mpm.records.variables import dataset_name, describe

    of, output = curve.of or name, experiment.output
    if of in output.probes and of not in output.observables:
        return f"temperature_{of}", "K"
    if of not in output.observables:
        return None
    return dataset_name(of), describe(dataset_name(of), experiment.grid.dimension, output.probes).units


def recorded(experiment: Any, name: str, curve: Measured) -> tuple[str, str]:
    """`target` of a curve of a config that was checked."""
    if (found := target(experiment, name, curve)) is None:
        raise KeyError(name)
    return found


def embed(experiment: Any, folder: Path) -> Iterator[Finding]:
    """Fill in `samples` from the files, which are relative to `folder`; yields what is wrong with them."""
    for name, curve in experiment.output.measured.items():
        place = ("output", "measured", name)
        found = target(experiment, name, curve)
        if found is None:
            known = [*experiment.output.probes, *experiment.output.observables]
            said = f"there is no probe {name!r}" if curve.of is None else f"{curve.of!r} is not recorded: it is no probe and not among output.observables"
            yield Finding(place if curve.of is None else (*place, "of"), said, known, near(curve.of or name, known), on_key=curve.of is None)
            continue
        ways = [key for key in ("file", "samples", "equals") if key in curve.model_fields_set and getattr(curve, key) not in ("", (), None)]
        if not curve.units and len(ways) != 1:
            said = f"{' and '.join(ways)}: the data is here twice" if ways else "where is the data?"
            yield Finding(place, said, ["file", "samples", "equals"], on_key=True)
            continue
        if not curve.units:
            try:
                update = data(curve, folder, found[1])
            except OSError as error:
                yield Finding((*place, "file"), f"cannot read {curve.file!r}: {error.strerror}", "a CSV file beside the config")
            except Unreadable as error:
                where = f"{curve.file}:{error.line}: " if error.line else f"{curve.file}: " if error.column == "file" and curve.file else ""
                key = error.column if error.column == "file" or error.column in curve.model_fields_set else "file"
                yield Finding((*place, key), f"{where}{error.message}", error.allowed)
            except ValueError as error:  # a name that no file can have
                yield Finding((*place, "file"), f"cannot read {brief(curve.file)}: {error}", "a CSV file beside the config")
            else:
                experiment.output.measured[name] = curve.model_copy(update=update)


def data(curve: Measured, folder: Path, units: str) -> dict[str, Any]:
    """What is filled in: numbers in SI."""
    made: dict[str, Any] = {"units": units, "file": Path(curve.file).name}
    sigma = curve.sigma
    if sigma is not None and not (isinstance(sigma, str) and sigma[:1].isalpha()):
        made["sigma"] = sigma = number(sigma, units, "sigma", "sigma", difference=True)
        if not sigma > 0:
            raise Unreadable(0, "sigma must be above 0", "a standard error", "sigma")
    if curve.equals is not None:
        return made | {"equals": number(curve.equals, units, "value", "equals")}
    if curve.file:
        column = sigma if isinstance(sigma, str) else ""
        made["samples"] = tuple(read(folder / curve.file, curve.time, curve.value, units, curve.unit, curve.start, column))
        return made | ({"sigma": None} if column else {})
    rows = []
    for row in curve.samples:
        if len(row) not in (2, 3) or len(row) != len(curve.samples[0]):
            raise Unreadable(0, "each sample is [time, value] or [time, value, sigma], all alike", "[[3 s, 62.8 mm], ...]", "samples")
        values = [number(row[0], "s", "time", "samples"), number(row[1], units, "value", "samples")]
        rows.append((*values, *(number(item, units, "sigma", "samples", difference=True) for item in row[2:])))
        if rows[-1][0] < 0 or (len(row) == 3 and not rows[-1][2] > 0):
            raise Unreadable(0, "a time before the start of the run, or a sigma that is not above 0", "0 or later, and a standard error", "samples")
    return made | {"samples": tuple(sorted(rows))}


def number(value: Any, units: str, what: str, key: str, difference: bool = False) -> float:
    """A number in SI, or text with a unit."""
    try:
        return Quantity("" if units == "1" else units, what, difference=difference).validate(value)
    except Exception as error:  # pydantic's own class, with the words in its context
        context = getattr(error, "context", None) or {}
        raise Unreadable(0, context.get("message", str(error)), context.get("allowed", ""), key) from None


__all__ = ["Measured", "Number", "Unreadable", "embed", "target"]
