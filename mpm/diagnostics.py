"""What a state amounts to: sums, extrema, energies, the heat ledger. Pure functions of one body."""

import math

import numpy as np

from mpm.basis import second_moment, stencil
from mpm.boundary import directions, extents
from mpm.heat.setting import conditions
from mpm.jit import kernel, role
from mpm.materials import HenckyWarm, energy, enthalpy, stress, value, warmed
from mpm.materials.laws import Constant
from mpm.state import Axisymmetric, Expansion, Latched, Line, NoExchange, Plane, Radiation, Softening, Thermal, Volume
from mpm.tensors import eigen2, eigen3


@role
def principal(space, B, i):
    """Principal elastic Hencky strains of particle i, sorted by nothing."""
    raise TypeError(f"no strain for {type(space).__name__}")


@principal.register(Line)
def principal_line(space, B, i):
    return 0.5 * math.log1p(B[i, 0]), 0.5 * math.log1p(B[i, 1]), 0.5 * math.log1p(B[i, 2])


@principal.register(Plane)
@principal.register(Axisymmetric)
def principal_axisymmetric_or_plane(space, B, i):
    l1, l2, _, _ = eigen2(B[i, 0], B[i, 1], B[i, 3])
    return 0.5 * math.log1p(l1), 0.5 * math.log1p(l2), 0.5 * math.log1p(B[i, 2])


@principal.register(Volume)
def principal_volume(space, B, i):
    values = eigen3(B[i, 0], B[i, 1], B[i, 2], B[i, 3], B[i, 4], B[i, 5])
    return 0.5 * math.log1p(values[0]), 0.5 * math.log1p(values[1]), 0.5 * math.log1p(values[2])


@kernel
def strains(space, B):
    """Principal elastic Hencky strains (N, 3)."""
    out = np.empty((B.shape[0], 3))
    for i in range(B.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = principal(space, B, i)
    return out


@kernel
def stored(law, e, V0, theta):
    """Sum V0 psi [J]; theta what laws are asked with (mpm.heat.setting.conditions)."""
    total = 0.0
    for i in range(V0.shape[0]):
        total += V0[i] * energy(warmed(law, theta[i]), e[i, 0], e[i, 1], e[i, 2])
    return total


def warm_energy(space, bodies) -> float:
    """Elastic energy of the bodies whose moduli follow temperature [J]: a heat step changes it at the same strain."""
    warm = [body for body in bodies if isinstance(body.elastic, HenckyWarm)]
    return sum(stored(body.elastic, strains(space, body.particles.B), body.particles.V0, conditions(body)) for body in warm)


@kernel
def stresses(law, e, thermal, theta):
    """Principal Kirchhoff stresses (N, 3) [Pa]; thermal (N,) is gamma (Theta - Theta_0), theta as in `stored`."""
    out = np.empty_like(e)
    for i in range(e.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = stress(warmed(law, theta[i]), e[i, 0], e[i, 1], e[i, 2], thermal[i])
    return out


@kernel
def enthalpies(law, theta):
    """Specific enthalpy (N,) [J/kg] of absolute temperatures."""
    out = np.empty(theta.shape[0])
    for i in range(theta.shape[0]):
        out[i] = enthalpy(law, theta[i])
    return out


def temperatures(body) -> np.ndarray:
    """Absolute temperatures (N,) [K]."""
    if isinstance(body.thermal, Thermal):
        return body.thermal.zero + body.thermal.theta.astype(float)
    return np.full(len(body.particles.m), body.thermal.temperature)


def thermal_pressure(body) -> np.ndarray:
    """gamma (Theta - Theta_0) of every particle [Pa]."""
    return pressure_of(body.expansion, body)


def pressure_of(expansion, body) -> np.ndarray:
    """The same, of one expansion."""
    if isinstance(expansion, Expansion):
        return expansion.gamma * (body.thermal.theta.astype(float) + expansion.shift)
    if isinstance(expansion, Latched):
        held = np.maximum(expansion.most, np.minimum(body.thermal.theta, expansion.set)).astype(float)
        return expansion.gamma * (held + expansion.shift)
    if isinstance(expansion, Softening):
        return np.array([value(expansion.E, t) for t in conditions(body)]) * pressure_of(expansion.inner, body)
    return np.zeros(len(body.particles.m))


@kernel
def specific_heats(law, theta):
    """alpha (N,) [J/(kg K)] at absolute temperatures."""
    out = np.empty(theta.shape[0])
    for i in range(theta.shape[0]):
        out[i] = value(law, theta[i])
    return out


def capacities(body) -> np.ndarray:
    """Heat capacity of each particle of a body that has heat (N,) [J/K]."""
    alpha, m = body.thermal.alpha, body.particles.m.astype(float)
    return m * (alpha.constant if isinstance(alpha, Constant) else specific_heats(alpha, temperatures(body)))


def heat_since(body, start: np.ndarray) -> float:
    """Heat taken up since temperatures were `start` (less zero) [J]."""
    thermal, m = body.thermal, body.particles.m
    if isinstance(thermal.alpha, Constant):
        return float(np.sum(m * thermal.alpha.constant * (thermal.theta.astype(float) - start)))
    return float(np.sum(m * (enthalpies(thermal.alpha, thermal.zero + thermal.theta.astype(float)) - enthalpies(thermal.alpha, thermal.zero + start))))


def kinetic(space, particles, slopes: bool = True) -> float:
    """1/2 sum m (|v|^2 + sum_d (sum w d^2) |C_d|^2): with the affine part, unless `slopes` is false [J]."""
    still = np.sum(particles.v.astype(float) ** 2, axis=1)
    if not slopes:
        return float(0.5 * np.sum(particles.m * still))
    moment = space.h**2 * second_moment(space.basis, particles.x / space.h)  # (N, D), or one number
    swirl = np.sum(moment * np.sum(particles.C.astype(float) ** 2, axis=1), axis=1)
    return float(0.5 * np.sum(particles.m * (still + swirl)))


@kernel
def nodal(space, x, weights, nodes):
    """nodes_i += sum_p weights_p w_ip: for fields on the grid. The weights alone of `transfer.scatter_scalar`, which takes three times as long to compile."""
    D, shape, M = directions(space), extents(space), len(stencil(space.basis, 0.5)[1])
    first, w = np.zeros(3, np.int64), np.ones((3, M))
    n1, n2 = M if D > 1 else 1, M if D > 2 else 1
    for p in range(x.shape[0]):
        for a in range(D):
            begins, along, _, _, _ = stencil(space.basis, x[p, a] / space.h)
            first[a] = begins
            for j in range(M):
                w[a, j] = along[j]
        for i in range(M):
            for j in range(n1):
                row = ((first[0] + i) * shape[1] + first[1] + j) * shape[2] + first[2]
                for k in range(n2):
                    nodes[row + k] += w[0, i] * w[1, j] * w[2, k] * weights[p]


def grid_shape(space) -> tuple[int, ...]:
    """Nodes by direction, as many as there are directions."""
    return extents(space)[: directions(space)]


def exchanging_area(body) -> float:
    """Present area of the pieces that exchange heat with what surrounds them now: J |F^-T A| (Nanson) [m^(D-1), axisymmetric m^2 per radian]."""
    if isinstance(body.surface, NoExchange):
        return 0.0
    surface = body.surface
    acting = (surface.beta > 0) | (surface.flux != 0)
    if isinstance(surface.radiation, Radiation):
        acting |= surface.radiation.emissivity > 0
    owner = surface.owner[acting]
    normal = np.einsum("sji,sj->si", np.linalg.inv(surface.F.astype(float))[surface.row[owner]], surface.area[acting])
    return float(np.sum(body.particles.J[owner].astype(float) * np.linalg.norm(normal, axis=1)))  # in no order of BLAS


def radius_holding(share: float, r, V) -> float:
    """Within which `share` of the volume lies: half of a particle's counts at its own radius."""
    order = np.argsort(r)
    inside = np.cumsum(V[order]) - 0.5 * V[order]
    return float(np.interp(share * np.sum(V), inside, r[order]))


def volume_ratios(names, bodies) -> dict[str, float]:
    """The volume of each body now over what it was [-]."""
    return {name: float(np.average(body.particles.J, weights=body.particles.V0)) for name, body in zip(names, bodies, strict=True)}
