"""Points that sampled at different times onto one axis.

Points of a sweep share their cadence, so usually all times are equal. Where `time.end` or the cadence itself is swept, the axis is the
union; a point that stopped early fills the front of it, and its last sample off the cadence is left in its own file.
"""

import numpy as np

TOLERANCE = 1e-9  # of the last time: two times this close are one


def axis(times: list[np.ndarray], ok: list[bool]) -> np.ndarray:
    """One increasing axis for all points: of those that are ok, or of the longest where none is."""
    distinct = {t.tobytes(): t for t, good in zip(times, ok, strict=True) if good and len(t)}
    if not distinct:
        return max(times, key=len, default=np.zeros(0))
    union = np.unique(np.concatenate(list(distinct.values())))
    apart = np.diff(union, prepend=-np.inf) > TOLERANCE * abs(union[-1])
    return union[apart]


def places(times: np.ndarray, onto: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which samples have a place on the axis, and which place."""
    if not len(onto) or not len(times):
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    right = np.minimum(np.searchsorted(onto, times), len(onto) - 1)
    left = np.maximum(right - 1, 0)
    near = np.where(abs(onto[left] - times) <= abs(onto[right] - times), left, right)
    samples = np.flatnonzero(abs(onto[near] - times) <= TOLERANCE * max(abs(onto[-1]), abs(times[-1])))
    return samples, near[samples]
