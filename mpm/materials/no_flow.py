"""Absent plastic flow: the trial strain is the elastic strain, and it costs nothing."""

from typing import NamedTuple

from mpm.lanes import like
from mpm.materials.roles import flow, flow_lanes, moduli, tangent


class NoFlow(NamedTuple):
    """Elastic for ever."""


@flow.register(NoFlow)
def flow_none(law, elastic, e1, e2, e3, thermal, theta, dt):
    return e1, e2, e3, 0.0, True


@flow_lanes.register(NoFlow)
def flow_lanes_no_flow(law, trace, deviator, lam, mu, thermal, theta, J, dt):
    one, nought = like(trace, 1.0), like(trace, 0.0)
    return trace, one, nought, nought, one


@tangent.register(NoFlow)
def tangent_no_flow(law, elastic, trace, size, thermal, theta, dt):
    lam, mu = moduli(elastic)
    K = lam + 2.0 * mu / 3.0
    p = thermal - K * trace
    return 0.5 * p * p / K + mu * size * size, p, 1.0, 1.0, 0.0, 1.0, 0.0, True
