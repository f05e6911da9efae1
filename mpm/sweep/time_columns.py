"""Arrays of many points over one axis of times, filled point by point.

Points of a sweep nearly always sample at the same times: those go into place at once, so that no record has to be kept. The others (a point that failed
early, a sweep over `time.end`) wait until all times are known (`align`).
"""

import numpy as np

from mpm.sweep.time_axis import axis, places


class TimeColumns:
    """`count` places. `times` is the axis of the first point that is ok; with `keep` false only the axis is worked out, and no value is kept."""

    def __init__(self, count: int, keep: bool = True):
        self.count, self.keep = count, keep
        self.times: np.ndarray | None = None
        self.columns: dict[str, np.ndarray] = {}
        self.odd: list[tuple[int, np.ndarray, bool, dict[str, np.ndarray]]] = []
        self.others: dict[bytes, tuple[np.ndarray, bool]] = {}  # other times, and whether a point that is ok has them

    def add(self, place: int, times: np.ndarray, values: dict[str, np.ndarray], ok: bool) -> None:
        """What a point sampled: (T,) times [s] and arrays (T, ...) by name."""
        if not len(times):
            return
        if self.times is None and ok:
            self.times = times
        if self.times is not None and np.array_equal(times, self.times):
            if self.keep:
                for name, rows in values.items():
                    self.column(name, rows, len(times))[place] = rows
            return
        key = times.tobytes()
        self.others[key] = (times, ok or self.others.get(key, (times, False))[1])
        if self.keep:
            self.odd.append((place, times, ok, values))

    def column(self, name: str, like: np.ndarray, length: int) -> np.ndarray:
        """The array of a name, made when it is first seen."""
        if name not in self.columns:
            self.columns[name] = np.full((self.count, length, *like.shape[1:]), np.nan, dtype=like.dtype)
        return self.columns[name]

    def drop(self) -> None:
        """Keep no values from here on."""
        self.keep, self.columns, self.odd = False, {}, []

    def axis(self) -> np.ndarray:
        """The axis that all points go onto."""
        known = [*([(self.times, True)] if self.times is not None else []), *self.others.values()]
        return axis([times for times, _ in known], [ok for _, ok in known])

    def laid(self, time: np.ndarray | None = None) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """The axis (`time` if it is given), and the arrays (count, len(axis), ...) over it; NaN where a point has no sample."""
        time = self.axis() if time is None else time
        if self.times is not None and not np.array_equal(time, self.times):
            samples, onto = places(self.times, time)
            for name, before in self.columns.items():
                after = np.full((self.count, len(time), *before.shape[2:]), np.nan, dtype=before.dtype)
                after[:, onto] = before[:, samples]
                self.columns[name] = after
        for place, times, _, values in self.odd:
            samples, onto = places(times, time)
            for name, rows in values.items():
                self.column(name, rows, len(time))[place, onto] = rows[samples]
        self.odd = []
        return time, self.columns
