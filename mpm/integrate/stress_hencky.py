"""What the particles of a chunk answer their trial strains: return map, heating, stress (docs/physics.md 4, steps 6 to 8), eight at once.

eps = 1/2 log(1 + B);  return map on the trace and the deviator's size;  heating;  tau = 2 mu eps + (lam tr eps - thermal stress) 1;  B = exp(2 eps) - 1.
In three dimensions without principal axes (mpm.isotropic), in a plane with those of its closed form. Neo-Hookean: stress_neo_hookean.py.
"""

from mpm.heat.lanes import grow_warmer, heat_eight
from mpm.heat.local import latch, temperature, thermal_stress
from mpm.heat.setting import condition, conditions_eight
from mpm.integrate.deformation import carry_owners
from mpm.integrate.strain import CODE, DISSIPATED, GROW, HEATED, JACOBIAN, STRAIN, SWELLED, deliver_plane, deliver_volume, fail
from mpm.isotropic import exponential3, largest, logarithm3, lowest3, norm, split
from mpm.jit import kernel, role
from mpm.lanes import (
    EIGHT,
    absolute,
    below,
    choose,
    expm1,
    fma,
    item,
    least,
    like,
    load8,
    log1p,
    maximum,
    minimum,
    most,
    peek,
    poke,
    put,
    splat8,
    sqrt,
    store,
)
from mpm.materials import FLOW, Hencky, HenckyWarm, NoFlow, flow_lanes, moduli_lanes
from mpm.outcome import INVERTED, RETURN_MAP
from mpm.state import Expansion, GridHeating, Heating, Latched, NoExchange, NoExpansion, NoHeating, Softening, Surface
from mpm.tensors import compose2, eigen2
from mpm.transfer import CHUNK

ACROSS = 4  # row of Chunk.e: stress out of plane
WARMTH, PRESSURE, LOST = 6, 7, 8  # rows of Chunk.e: temperature [K], thermal stress [Pa], dissipated [J/m3]


@role
def flows(law):
    """Whether the elastic strain must be written back: a constant at compile time."""
    raise TypeError(f"no flow law {type(law).__name__}")


@flows.register(NoFlow)
def flows_no_flow(law):
    return False


def flows_always(law):
    return True


for kind in FLOW:
    if kind is not NoFlow:
        flows.register(kind, flows_always)


@role
def warms(heating):
    """Whether strain and flow change the temperature: a constant at compile time."""
    raise TypeError(f"no heating in {type(heating).__name__}")


@warms.register(NoHeating)
def warms_no_heating(heating):
    return False


@warms.register(Heating)
@warms.register(GridHeating)
def warms_grid_heating_or_heating(heating):
    return True


@role
def swells(expansion):
    """Whether thermal stress works on what stretches: a constant at compile time."""
    raise TypeError(f"no thermal stress in {type(expansion).__name__}")


@swells.register(NoExpansion)
def swells_no_expansion(expansion):
    return False


@swells.register(Expansion)
@swells.register(Latched)
@swells.register(Softening)
def swells_softening_or_latched_or_expansion(expansion):
    return True


@kernel(inline=True)
def tell(body, chunk, first, p, count):
    """Temperatures and thermal stresses of eight particles in their rows of chunk.e; what lies behind the last one repeats it."""
    e, n = chunk.e, CHUNK
    for q in range(p, p + EIGHT):
        i = first + min(q, count - 1)
        poke(e, WARMTH * n + q, temperature(body.thermal, i))
        poke(e, PRESSURE * n + q, thermal_stress(body.expansion, body.thermal, i, condition(body.setting, body.thermal, i)))


@kernel(inline=True)
def blame(report, code, good, i, count):
    """Fail the first of the particles from i whose lane is not good."""
    for k in range(min(EIGHT, count)):
        if not item(good, k) > 0.5:
            fail(report, code, i + k)


@kernel(inline=True)
def heat_all(body, chunk, first, p, count, report):
    """Heat the particles p.. of the chunk by what they stretched (row GROW) and dissipated (row LOST); remember what they reached."""
    e, n, particles = chunk.e, CHUNK, body.particles
    gained = risen = splat8(0.0)
    if warms(body.heating):
        theta, density, stretched, lost = gained, gained, gained, gained  # in float64: a rise is a small difference
        for k in range(EIGHT):
            q = min(p + k, count - 1)
            theta = put(theta, k, float(temperature(body.thermal, first + q)))
            density = put(density, k, float(peek(particles.m, first + q) / peek(particles.V0, first + q)))
            stretched, lost = put(stretched, k, float(peek(e, GROW * n + q))), put(lost, k, float(peek(e, LOST * n + q)))
        gained, risen = heat_eight(body.heating, body.thermal, theta, density, stretched, lost)
    heated, dissipated, swelled = report[HEATED], report[DISSIPATED], report[SWELLED]  # not through memory, particle by particle
    for k in range(min(EIGHT, count - p)):
        i, V0 = first + p + k, peek(particles.V0, first + p + k)
        if warms(body.heating):
            grow_warmer(body.thermal, i, item(risen, k))
            heated += V0 * item(gained, k)
        dissipated += V0 * float(peek(e, LOST * n + p + k))
        if swells(body.expansion):
            swelled += V0 * float(peek(e, PRESSURE * n + p + k)) * float(peek(e, GROW * n + p + k))
        latch(body.expansion, body.thermal, i)
    report[HEATED], report[DISSIPATED], report[SWELLED] = heated, dissipated, swelled


@kernel(inline=True)
def answer(body, chunk, first, p, count, trace, deviator, dt, report):
    """Return map and heating of eight particles, from the trace of the trial strain and the norm of its deviator.

    (trace, share of the deviator that is left, flowed 0 or 1, lam, mu, thermal stress), all as lanes.
    """
    e, n = chunk.e, CHUNK
    tell(body, chunk, first, p, count)
    theta, thermal = conditions_eight(body.setting, load8(e, WARMTH * n + p), first + p, count - p), load8(e, PRESSURE * n + p)
    lam, mu = moduli_lanes(body.elastic, theta)
    share, flowed = like(trace, 1.0), like(trace, 0.0)
    if dt > 0.0:
        before = trace
        trace, share, lost, flowed, good = flow_lanes(body.flow, trace, deviator, lam, mu, thermal, theta, load8(e, JACOBIAN * n + p), dt)
        if not least(good) > 0.5:
            blame(report, RETURN_MAP, good, first + p, count - p)
        if warms(body.heating) or swells(body.expansion) or most(flowed) > 0.5:
            store(e, LOST * n + p, lost)
            if warms(body.heating) or swells(body.expansion):
                store(e, GROW * n + p, (trace - before) + log1p(load8(e, GROW * n + p)))
            heat_all(body, chunk, first, p, count, report)
        if warms(body.heating):
            tell(body, chunk, first, p, count)
            theta, thermal = conditions_eight(body.setting, load8(e, WARMTH * n + p), first + p, count - p), load8(e, PRESSURE * n + p)
            lam, mu = moduli_lanes(body.elastic, theta)
    return trace, share, flowed, lam, mu, thermal


@role(inline=True)
def carry_surface(surface, chunk, first, count, dt, D):
    """F of the particles that own pieces of surface."""
    raise TypeError(f"no surface {type(surface).__name__}")


@carry_surface.register(NoExchange)
def carry_surface_no_exchange(surface, chunk, first, count, dt, D):
    return None


@carry_surface.register(Surface)
def carry_surface_surface(surface, chunk, first, count, dt, D):
    carry_owners(surface.F, surface.row, chunk.L, first, count, dt, D)


@role(inline=True)
def stress_plane(elastic, body, chunk, first, count, dt, report):
    """From trial strain to the particles' B and to tau in chunk.S, out of plane in chunk.e[ACROSS], of a plane or axisymmetric body."""
    raise TypeError(f"no response of {type(elastic).__name__}")


@role(inline=True)
def stress_volume(elastic, body, chunk, first, count, dt, report):
    """The same in three directions."""
    raise TypeError(f"no response of {type(elastic).__name__}")


@kernel(inline=True)
def size3(d1, d2, d3):
    """Norm of a deviator, zero where its squares would be subnormal."""
    keep = below(like(d1, 1e-17), maximum(maximum(absolute(d1), absolute(d2)), absolute(d3)))
    d1, d2, d3 = keep * d1, keep * d2, keep * d3
    return sqrt(fma(d1, d1, fma(d2, d2, d3 * d3)))


@stress_plane.register(Hencky)
@stress_plane.register(HenckyWarm)
def stress_plane_hencky_warm_or_hencky(elastic, body, chunk, first, count, dt, report):
    e, S, n, real = chunk.e, chunk.S, CHUNK, chunk.e.dtype.type
    third, lowest, minus = real(1.0 / 3.0), splat8(real(0)), splat8(real(-1))
    for p in range(0, count, EIGHT):
        xx, yy, zz, xy = load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p)
        l1, l2, c, s = eigen2(xx, yy, xy)
        sound = below(minus, minimum(minimum(l1, l2), zz))
        if not least(sound) > 0.5:
            blame(report, INVERTED, sound, first + p, count - p)
            return
        e1, e2, e3 = 0.5 * log1p(l1), 0.5 * log1p(l2), 0.5 * log1p(zz)
        lowest = minimum(minimum(minimum(e1, e2), e3), lowest)
        d1, d2, d3 = third * ((e1 - e2) + (e1 - e3)), third * ((e2 - e1) + (e2 - e3)), third * ((e3 - e1) + (e3 - e2))
        trace, share, flowed, lam, mu, thermal = answer(body, chunk, first, p, count, e1 + e2 + e3, size3(d1, d2, d3), dt, report)
        if report[CODE] != 0.0:
            return
        bulk, double = lam * trace - thermal, 2.0 * mu
        if most(flowed) > 0.5:
            e1, e2, e3 = fma(share, d1, third * trace), fma(share, d2, third * trace), fma(share, d3, third * trace)
            nxx, nyy, nxy = compose2(expm1(2.0 * e1), expm1(2.0 * e2), c, s)
            store(e, p, choose(flowed, nxx, xx))
            store(e, n + p, choose(flowed, nyy, yy))
            store(e, 2 * n + p, choose(flowed, expm1(2.0 * e3), zz))
            store(e, 3 * n + p, choose(flowed, nxy, xy))
        xx, yy, xy = compose2(fma(double, e1, bulk), fma(double, e2, bulk), c, s)
        store(S, p, xx)
        store(S, n + p, xy)
        store(S, 2 * n + p, xy)
        store(S, 3 * n + p, yy)
        store(e, ACROSS * n + p, fma(double, e3, bulk))
    report[STRAIN] = min(report[STRAIN], least(lowest))
    deliver_plane(body.particles, chunk, first, count)
    carry_surface(body.surface, chunk, first, count, dt, 2)


@stress_volume.register(Hencky)
@stress_volume.register(HenckyWarm)
def stress_volume_hencky_warm_or_hencky(elastic, body, chunk, first, count, dt, report):
    if not flows(body.flow):
        deliver_volume(body.particles, chunk, first, count)
    e, S, n, real = chunk.e, chunk.S, CHUNK, chunk.e.dtype.type
    lowest, minus = splat8(real(0)), splat8(real(-1))
    for p in range(0, count, EIGHT):
        B = (load8(e, p), load8(e, n + p), load8(e, 2 * n + p), load8(e, 3 * n + p), load8(e, 4 * n + p), load8(e, 5 * n + p))
        strain, sound = logarithm3(B)
        sound = below(minus, sound)
        if not least(sound) > 0.5:
            blame(report, INVERTED, sound, first + p, count - p)
            return
        mean, D = split(strain)
        size = norm(D, largest(D))
        lowest = minimum(lowest3(strain, mean, size), lowest)
        trace, share, flowed, lam, mu, thermal = answer(body, chunk, first, p, count, 3.0 * mean, size, dt, report)
        if report[CODE] != 0.0:
            return
        bulk, double = fma(lam, trace, 2.0 / 3.0 * mu * trace) - thermal, 2.0 * mu * share
        xy, yz, xz = double * D[3], double * D[4], double * D[5]
        store(S, p, fma(double, D[0], bulk))
        store(S, n + p, xy)
        store(S, 2 * n + p, xz)
        store(S, 3 * n + p, xy)
        store(S, 4 * n + p, fma(double, D[1], bulk))
        store(S, 5 * n + p, yz)
        store(S, 6 * n + p, xz)
        store(S, 7 * n + p, yz)
        store(S, 8 * n + p, fma(double, D[2], bulk))
        if most(flowed) > 0.5:
            grown = exponential3(1.0 / 3.0 * trace, (share * D[0], share * D[1], share * D[2], share * D[3], share * D[4], share * D[5]))
            for k in range(6):
                store(e, k * n + p, choose(flowed, grown[k], B[k]))
    report[STRAIN] = min(report[STRAIN], least(lowest))
    if flows(body.flow):
        deliver_volume(body.particles, chunk, first, count)
    carry_surface(body.surface, chunk, first, count, dt, 3)
