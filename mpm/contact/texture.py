"""Texture profile analysis: what a press that bites twice says of a body (Bourne 1978, Food Technology 32, 62; Szczesniak 1963).

hardness       largest force of the first bite
cohesiveness   work of the second way down over that of the first
springiness    way of the second bite, from touch to its end, over that of the first
A bite is the time from touch (force above TOUCH of the largest) to the end of the way down. Force and way are told at the output times, force as the mean since
the one before, so that sums are impulses.
Good values    fifty outputs a bite.
Fails when     the press does not come free between its bites, or bites once: NaN, but for the hardness; it touches nothing: NaN.
"""

import numpy as np

TOUCH = 0.01  # of the largest force


def bites(force: np.ndarray, way: np.ndarray) -> list[tuple[float, float, float]]:
    """(largest force [N], work [J], way [m]) of each bite; force (T,) against the press, positive, and how far down it is (T,)."""
    found, touched, down = [], force > TOUCH * force.max(initial=0.0), np.diff(way, prepend=way[0]) > 0
    acting = touched & down
    begins = np.flatnonzero(acting & ~np.concatenate([[False], acting[:-1]]))
    free = True
    for first, last in zip(begins, [*begins, len(way)][1:], strict=True):
        between = slice(found[-1][3] if found else 0, first)
        free = not found or not touched[between].all()
        end = first + int(np.argmin(acting[first:last])) if not acting[first:last].all() else last
        work = float(np.sum(force[first:end] * np.diff(way, prepend=way[0])[first:end]))
        length = float(way[end - 1] - way[max(first - 1, 0)])
        if free:
            found.append((float(force[first:end].max()), work, length, end))
        else:  # the same bite, after a halt
            most, before, so_far, _ = found[-1]
            found[-1] = max(most, float(force[first:end].max())), before + work, so_far + length, end
    return [one[:3] for one in found]


def texture(force: np.ndarray, way: np.ndarray) -> dict[str, float]:
    """hardness [N], cohesiveness and springiness; NaN where there is no bite, or no second one."""
    (hard, work, length), (_, again, less) = [*bites(force, way), (np.nan, np.nan, np.nan), (np.nan, np.nan, np.nan)][:2]
    return {"hardness": hard, "cohesiveness": again / work, "springiness": less / length}
