"""The body force and the heat that a config gives (`sources`), at every particle.

impulse   m b(X, t) dt on to the nodes with the stress     heat   theta grows by q(X, t + dt/2, Theta) dt/(R0 alpha) through the enthalpy
X is the place at the start, q is by volume of the undeformed body. Second order in the step: q that depends on Theta is taken at the
temperature that half a step leads to.
A body without `sources` compiles none of this.
"""

from mpm.heat.local import rise, temperature
from mpm.integrate.strain import SOURCED, WORKED
from mpm.integrate.traction import act
from mpm.jit import role
from mpm.sources import Both, Force, Given, Jumping, NoForce, NoWarming, Warming, evaluate

BEFORE = 3e-9  # of a time: before a jump at it (mpm.sources.formula, AFTER)


@role
def warm(heat, source, body, first, count, dt, report):
    """Heat of the past step to the particles."""
    raise TypeError(f"no heat of {type(heat).__name__}")


@warm.register(NoWarming)
def warm_not(heat, source, body, first, count, dt, report):
    return None


@warm.register(Warming)
def warm_warming(heat, source, body, first, count, dt, report):
    if dt == 0.0:
        return
    stack, theta, thermal, middle = source.stack, source.theta, body.thermal, source.t[first] + 0.5 * dt
    for i in range(first, first + count):
        theta[i] = temperature(thermal, i)
    evaluate(heat.code, source.X, first, count, middle, theta, stack)
    if heat.code.feels:
        for i in range(first, first + count):
            theta[i] += rise(thermal.alpha, theta[i], 0.5 * dt * stack[0, i])
        evaluate(heat.code, source.X, first, count, middle, theta, stack)
    for i in range(first, first + count):
        given, before = dt * stack[0, i], float(thermal.theta[i])
        wanted = rise(thermal.alpha, thermal.zero + before, given) + source.rest[i]
        thermal.theta[i] += wanted
        source.rest[i] = wanted - (float(thermal.theta[i]) - before)
        report[SOURCED] += body.particles.m[i] * given


@role
def push_at(force, source, body, first, count, t):
    """Force by mass at time t, to source.b."""
    raise TypeError(f"no force of {type(force).__name__}")


@push_at.register(NoForce)
def push_at_no_force(force, source, body, first, count, t):
    return None


@push_at.register(Force)
@push_at.register(Jumping)
def push_at_force_or_jumping(force, source, body, first, count, t):
    for i in range(first, first + count):
        source.theta[i] = temperature(body.thermal, i)
    for c in range(len(force.codes)):
        evaluate(force.codes[c], source.X, first, count, t, source.theta, source.stack)
        for i in range(first, first + count):
            source.b[i, c] = source.stack[0, i]


@role
def mix_past(force, source, body, first, count, t):
    """As a block of steps opens at t: of a force that may jump there, the share of the first impulse that acts before, to source.b."""
    raise TypeError(f"no force of {type(force).__name__}")


@mix_past.register(NoForce)
@mix_past.register(Force)
def mix_past_no_force_or_force(force, source, body, first, count, t):
    return None


@mix_past.register(Jumping)
def mix_past_jumping(force, source, body, first, count, t):
    for c in range(len(force.codes)):
        evaluate(force.codes[c], source.X, first, count, t * (1.0 - BEFORE), source.theta, source.stack)
        for i in range(first, first + count):
            source.b[i, c] += force.past[0] * (source.stack[0, i] - source.b[i, c])


@act.register(Given)
def act_given(source, body, chunk, first, count, dt, next_dt, report):
    m, D = body.particles.m, source.X.shape[1]
    if dt > 0.0:
        for p in range(count):
            for c in range(D):
                report[WORKED] += dt * m[first + p] * source.b[first + p, c] * chunk.v[c, p]
    warm(source.heat, source, body, first, count, dt, report)
    for p in range(count):
        source.t[first + p] += dt
    push_at(source.force, source, body, first, count, source.t[first])
    if dt == 0.0:
        mix_past(source.force, source, body, first, count, source.t[first])
    for p in range(count):
        for c in range(D):
            chunk.f[c, p] += next_dt * m[first + p] * source.b[first + p, c]


@act.register(Both)
def act_both(source, body, chunk, first, count, dt, next_dt, report):
    act(source.load, body, chunk, first, count, dt, next_dt, report)
    act(source.given, body, chunk, first, count, dt, next_dt, report)
