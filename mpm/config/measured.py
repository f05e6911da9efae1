"""Measured curves: a CSV beside the config, read when the config is, so that a point carries its data and no path.

Columns are named with their units: `minute`, `second`, `hour`; temperatures end in `_degC` or `_K`. Lines that start with # are comments.
"""

import csv
import math
from collections.abc import Iterator
from pathlib import Path

from mpm.config.base import Model, doc
from mpm.config.explain import Finding

SECONDS = {"second": 1.0, "minute": 60.0, "hour": 3600.0}
KELVIN = {"_degC": 273.15, "_K": 0.0}


class Measured(Model):
    """A measured temperature at a probe."""

    file: str = doc(description="CSV file, relative to the config")
    time: str = doc("second", description="column of the time: second, minute or hour")
    value: str = doc(description="column of the temperature; its name ends in _degC or _K")
    samples: tuple[tuple[float, float], ...] = doc((), description="what the file holds: (second, kelvin); filled in when the config is read")


def embed(experiment, folder: Path) -> Iterator[Finding]:
    """Fill in `samples` from the files, which are relative to `folder`; yields what is wrong with them."""
    for probe, curve in experiment.output.measured.items():
        place = ("output", "measured", probe)
        if probe not in experiment.output.probes:
            yield Finding(place, f"there is no probe {probe!r}", list(experiment.output.probes), on_key=True)
        elif not curve.samples:
            try:
                samples = tuple(read(folder / curve.file, curve.time, curve.value))
            except OSError as error:
                yield Finding((*place, "file"), f"cannot read {curve.file!r}: {error.strerror}", "a CSV file beside the config")
                continue
            except KeyError as error:
                yield Finding((*place, "value" if error.args[0] == curve.value else "time"), f"no such column: {error.args[0]!r}", error.args[1])
                continue
            except ValueError as error:
                yield Finding((*place, "file"), f"{curve.file}: {error}", "a CSV file with a header and numbers")
                continue
            experiment.output.measured[probe] = curve.model_copy(update={"samples": samples, "file": Path(curve.file).name})


def read(path: Path, time: str, value: str) -> Iterator[tuple[float, float]]:
    """(second, kelvin) of every row; KeyError(column, allowed) for a column that is not there or has no unit."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        columns = list(rows.fieldnames or [])
        suffix = next((suffix for suffix in KELVIN if value.endswith(suffix)), None)
        if value not in columns or suffix is None:
            raise KeyError(value, [name for name in columns if name.endswith(tuple(KELVIN))])
        if time not in columns or time not in SECONDS:
            raise KeyError(time, [name for name in columns if name in SECONDS])
        for row in rows:
            pair = float(row[time]) * SECONDS[time], float(row[value]) + KELVIN[suffix]
            if not all(map(math.isfinite, pair)):
                raise ValueError("a number is not finite")
            yield pair
