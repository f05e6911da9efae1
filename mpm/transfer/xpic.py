"""XPIC of order k (Hammerquist & Nairn 2017): FLIP whose particle velocities are cleaned of what the grid cannot see.

v_p = [1 - (1 - G P)^k] v_p + sum w (v_i+ - v_i), P particles to nodes, G nodes to particles; k = 1 is PIC. On the nodes that is one more gather and scatter
an order: q_1 = v_i, q_(j+1) = q_1 + (1 - P G) q_j, and v_p = sum w (q_k + v_i+ - v_i) (mpm.integrate.xpic keeps the change so). A mode of wave number
kappa loses (kappa h/2)^(2 k) of itself a step.
Good values: order 2 to 5.   Fails when: long runs of many small steps must keep modes of a few cells: APIC loses 0.024 (kappa h)^4, as order 2 does about.
"""

from typing import NamedTuple

from mpm.lanes import EIGHT, load8, store
from mpm.transfer.flip import collect_apart, spread_apart
from mpm.transfer.roles import CHUNK, carry, collect, deliver, spread, wants_change


class Xpic(NamedTuple):
    """order >= 1."""

    order: int


@carry.register(Xpic)
def carry_xpic(scheme, particles, first, chunk, count, last):
    for k in range(0, chunk.u.shape[0] * CHUNK, EIGHT):
        store(chunk.u, k, load8(chunk.change, k))
    chunk.U[:] = 0.0
    if last:
        deliver(particles, first, chunk, count)


@wants_change.register(Xpic)
def wants_change_xpic(scheme):
    return True


spread.register(Xpic, spread_apart)
collect.register(Xpic, collect_apart)
