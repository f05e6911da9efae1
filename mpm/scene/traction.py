"""Loads of a config to the run-time Load of a body: forces and their moments about the particles, from the cut surface."""

import numpy as np

from mpm.basis import inverse_moment
from mpm.scene.menus import pulling
from mpm.scene.refusal import SceneError
from mpm.scene.shapes import on_side
from mpm.state import Load, NoSource
from mpm.transfer import uses_basis_gradient


def one_ramp(experiment, name: str, tractions) -> set[float]:
    """The ramp of the tractions on one body; SceneError where they have several."""
    ramps = {entry.traction.ramp for entry in tractions}
    if len(ramps) > 1:
        said = f"the tractions on {name} have ramps of {', '.join(f'{ramp:g} s' for ramp in sorted(ramps))}: give them the same"
        raise SceneError(("loads", experiment.loads.index(tractions[-1]), "traction"), said)
    return ramps


def loaded(experiment, name: str, cut, space, gradient):
    """The Load of one body; NoSource where nothing acts on it."""
    entries = [entry for entry in experiment.loads if entry.of == name]
    tractions, rate = pulling(entries)
    if not tractions and rate == 0:
        return NoSource()
    ramps = one_ramp(experiment, name, tractions)
    N, D = cut.centroid.shape
    force, dipole = np.zeros((N, D)), np.zeros((N, D, D))
    for entry in tractions:
        pieces = np.flatnonzero(on_side(cut.normal, entry.side))
        if len(pieces) == 0:
            raise SceneError(("loads", experiment.loads.index(entry)), f"{name} has no surface on its side {entry.side!r}: nothing would be loaded")
        each = cut.area[pieces, None] * np.array(entry.traction.nominal)
        lever = cut.point[pieces] - cut.centroid[cut.owner[pieces]]
        np.add.at(force, cut.owner[pieces], each)
        np.add.at(dipole, cut.owner[pieces], each[:, :, None] * lever[:, None, :])
    scale = 1.0 if uses_basis_gradient(gradient) else inverse_moment(space.basis) / space.h**2
    held = np.tile(np.eye(D), (N, 1, 1))
    carries = np.any(force != 0, axis=1) | np.any(dipole != 0, axis=(1, 2))
    return Load(force, dipole, held, carries, np.zeros(N), max(ramps, default=0.0), rate, float(scale))
