"""The prescribed history of a material point as functions of time: what the exact solutions of grid.dimension 0 are written in."""

import numpy as np

AXES = ("xx", "yy", "zz")


def point(experiment):
    """Body and material of a material point."""
    if experiment.grid.dimension != 0:
        raise ValueError("this exact solution is for a material point: grid.dimension 0")
    ((_, body),) = experiment.bodies.items()
    return body, experiment.materials[body.material]


def constant(law, name: str) -> float:
    """The value of a constant law."""
    if type(law).kind != "constant":
        raise ValueError(f"the exact solution needs a constant {name}, not a {type(law).kind}")
    return float(law.value)


def ends(experiment) -> list[float]:
    """End of each stage [s]."""
    return [experiment.time.end if stage.until is None else stage.until for stage in experiment.loading]


def strains(experiment, times: np.ndarray) -> np.ndarray:
    """Prescribed logarithmic strains (T, 3), from the one at the start. ValueError where a stress is prescribed instead."""
    body, _ = point(experiment)
    found = np.tile([getattr(body.shape.strain, axis) for axis in AXES], (len(times), 1))
    start, before = 0.0, found[0].copy() if len(times) else np.zeros(3)
    for stage, end in zip(experiment.loading, ends(experiment), strict=True):
        inside, at_end = times >= start, before.copy()
        for k, axis in enumerate(AXES):
            rate, stretch = getattr(stage.strain_rate, axis), getattr(stage.stretch_rate, axis)
            if getattr(stage.stress, axis) is not None:
                raise ValueError("the exact solution needs every strain prescribed")
            if stretch is not None:
                found[inside, k] = np.log(np.exp(before[k]) + stretch * (times[inside] - start))
                at_end[k] = np.log(np.exp(before[k]) + stretch * (end - start))
            else:
                found[inside, k] = before[k] + (rate or 0.0) * (times[inside] - start)
                at_end[k] = before[k] + (rate or 0.0) * (end - start)
        start, before = end, at_end
    return found


def temperatures(experiment, times: np.ndarray) -> np.ndarray:
    """Prescribed temperatures (T,). ValueError where a stage leaves it to the material."""
    body, _ = point(experiment)
    if any(stage.temperature is None for stage in experiment.loading):
        raise ValueError("the exact solution needs the temperature prescribed in every stage")
    return np.interp(times, [0.0, *ends(experiment)], [body.temperature, *(stage.temperature for stage in experiment.loading)])
