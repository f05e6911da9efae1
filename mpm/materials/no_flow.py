"""Absent plastic flow: the trial strain is the elastic strain, and it costs nothing."""

from typing import NamedTuple

from mpm.materials.roles import flow


class NoFlow(NamedTuple):
    """Elastic for ever."""


@flow.register(NoFlow)
def flow_none(law, elastic, e1, e2, e3, thermal, theta, dt):
    return e1, e2, e3, 0.0, True
