"""Fields of snapshots and sums of motion: of the grid, and of particles: one function a name, of the scene, the body and where its particles were at the start.

Tensors have a column a component, in the order of mpm.state (mpm.records.variables.components).
stress              Cauchy [Pa];   strain: elastic Hencky strain, 1/2 log of F_e F_e^T [-], the thermal part included
stress_recovered    the same from patches (`patches`): linear stress comes out as it is, and what gradients err within a cell is evened out
displacement        x - X in both frames;   reference_position X;   id: the same number in every snapshot
velocity_gradient   grad v [1/s], rows of v: of the nodes in the total frame, the slopes that affine transfers carry in the updated one
"""

import math

import numpy as np

from mpm.boundary import extents
from mpm.diagnostics import grid_shape, nodal, strains, stresses, temperatures, thermal_pressure
from mpm.error import PLACES, kirchhoff
from mpm.follow import moved
from mpm.heat.setting import conditions
from mpm.records.variables import components
from mpm.state import PAD, Axisymmetric, Setting
from mpm.total.reference import sample
from mpm.transfer import columns

FLAT = 1e-3  # of a squared cell: along what a patch is thinner it has no slope
AXES = {1: ("x",), 2: ("x", "y"), 3: ("x", "y", "z")}


def particle_fields(scene, origins) -> dict[str, np.ndarray]:
    """The particle fields asked for, bodies one after another; origins: X (N, D) of each body."""
    made = {
        "position": lambda body, X: body.particles.x,
        "velocity": lambda body, X: body.particles.v,
        "temperature": lambda body, X: temperatures(body),
        "setting": lambda body, X: body.setting.X if isinstance(body.setting, Setting) else np.zeros(len(X)),
        "J": lambda body, X: body.particles.J,
        "mass": lambda body, X: body.particles.m,
        "pressure": lambda body, X: -principal_cauchy(scene, body).mean(axis=1),
        "stress_mises": lambda body, X: mises(principal_cauchy(scene, body)),
        "stress": lambda body, X: cauchy(body),
        "stress_recovered": lambda body, X: recovered(scene.space, body),
        "strain": lambda body, X: hencky(body),
        "displacement": lambda body, X: body.particles.x.astype(float) - X,
        "reference_position": lambda body, X: X,
        "velocity_gradient": lambda body, X: body.particles.C.reshape(len(X), -1),
    }
    fields = {}
    for name in scene.watch.particles:
        if name == "body":
            fields[name] = np.concatenate([np.full(len(body.particles.m), k, np.int32) for k, body in enumerate(scene.bodies)])
        elif name == "id":
            firsts = np.cumsum([0, *map(len, origins)])  # counted with what is still to come, so each keeps its number
            fields[name] = np.concatenate([np.arange(k, k + len(body.particles.m), dtype=np.int32) for k, body in zip(firsts, scene.bodies, strict=False)])
        else:
            fields[name] = np.concatenate([np.array(made[name](body, X[: len(body.particles.m)])) for body, X in zip(scene.bodies, origins, strict=True)])
    return fields


def cauchy(body) -> np.ndarray:
    """Cauchy stress (N, K) [Pa]."""
    return kirchhoff(body) / body.particles.J[:, None].astype(float)


def patches(space, body) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(volume (n,), a (n, K), b (n, K, D)): a + b x is the linear function that fits the Cauchy stress best round each node [Pa, Pa/m].

    Least squares over the particles that see the node, each by w V: superconvergent patches (Zienkiewicz & Zhu 1992) of particles in place of Gauss points.
    Where a patch holds one layer of particles only it is constant across.
    """
    x, sigma, V = body.particles.x.astype(float), cauchy(body), (body.particles.V0 * body.particles.J).astype(float)
    (N, D), K, n = x.shape, sigma.shape[1], math.prod(extents(space))
    columns_of = np.concatenate(
        [np.ones((N, 1)), x, (x[:, :, None] * x[:, None]).reshape(N, -1), sigma, (sigma[:, :, None] * x[:, None]).reshape(N, -1)], axis=1
    )
    sums = np.zeros((columns_of.shape[1], n))
    for row, column in zip(sums, (V[:, None] * columns_of).T, strict=True):
        nodal(space, np.ascontiguousarray(x), np.ascontiguousarray(column), row)
    volume, seen = sums[0], sums[0] > 0
    means = np.where(seen, sums / np.where(seen, volume, 1.0), 0.0).T
    middle, square, mean, cross = np.split(means[:, 1:], np.cumsum([D, D * D, K]), axis=1)
    spread = square.reshape(n, D, D) - middle[:, :, None] * middle[:, None]
    size, axes = np.linalg.eigh(spread)
    inverse = np.where(size > FLAT * space.h**2, 1 / np.where(size > FLAT * space.h**2, size, 1.0), 0.0)
    slope = (cross.reshape(n, K, D) - mean[:, :, None] * middle[:, None]) @ (axes * inverse[:, None]) @ np.swapaxes(axes, 1, 2)
    return volume, mean - np.einsum("nkd,nd->nk", slope, middle), slope


def recovered(space, body) -> np.ndarray:
    """Recovered Cauchy stress of the particles (N, K) [Pa]: sum w (a + b x) of their nodes' patches."""
    x = np.ascontiguousarray(body.particles.x, dtype=float)
    _, a, b = patches(space, body)
    (N, D), (n, K) = x.shape, a.shape
    fields = np.concatenate([a, b.reshape(n, -1)], axis=1)
    found = np.zeros((N, fields.shape[1]))
    for first in range(0, fields.shape[1], D):
        some, value = fields[:, first : first + D], np.zeros((N, D))
        nodes = np.zeros((n, columns(D)))
        nodes[:, : some.shape[1]] = some
        sample(space, nodes, x, value, np.zeros((N, D, D)))
        found[:, first : first + D] = value[:, : some.shape[1]]
    return found[:, :K] + np.einsum("nkd,nd->nk", found[:, K:].reshape(N, K, D), x)


def hencky(body) -> np.ndarray:
    """Elastic Hencky strain (N, K), components as B has them."""
    B = body.particles.B.astype(float)
    full = np.tile(np.eye(3), (len(B), 1, 1))
    for k, (i, j) in enumerate(PLACES[B.shape[1]]):
        full[:, i, j] += B[:, k]
        full[:, j, i] = full[:, i, j]
    values, axes = np.linalg.eigh(full)
    tensor = np.einsum("nik,nk,njk->nij", axes, 0.5 * np.log(values), axes)
    return np.stack([tensor[:, i, j] for i, j in PLACES[B.shape[1]]], axis=1)


def principal_cauchy(scene, body) -> np.ndarray:
    tau = stresses(body.elastic, strains(scene.space, body.particles.B), thermal_pressure(body), conditions(body))
    return tau / body.particles.J[:, None]


def mises(sigma: np.ndarray) -> np.ndarray:
    """sqrt(3/2) |dev sigma|."""
    return math.sqrt(1.5) * np.linalg.norm(sigma - sigma.mean(axis=1, keepdims=True), axis=1)


def grid_fields(scene) -> dict[str, np.ndarray]:
    """Fields on the nodes inside the domain, last direction first ([z,] [y,] x), float32; NaN where no material is."""
    shape = grid_shape(scene.space)
    n = math.prod(extents(scene.space))

    def gathered(weights):
        nodes = np.zeros(n)
        for body in scene.bodies:
            nodal(scene.space, body.particles.x, np.ascontiguousarray(weights(body), dtype=float), nodes)
        inner = nodes.reshape(shape)[tuple(slice(PAD, size - PAD) for size in shape)]
        return inner.transpose(*range(len(shape) - 1, -1, -1))

    mass = gathered(lambda body: body.particles.m)
    volume = gathered(lambda body: body.particles.V0 * body.particles.J)
    fields = {}
    with np.errstate(invalid="ignore", divide="ignore"):
        if "density" in scene.watch.grid:
            fields["density"] = (mass / volume).astype(np.float32)
        if "velocity" in scene.watch.grid:
            for k, axis in enumerate(axis_names(scene.space)):
                fields[f"velocity_{axis}"] = (gathered(lambda body, k=k: body.particles.m * body.particles.v[:, k]) / mass).astype(np.float32)
        if "temperature" in scene.watch.grid:
            heat = gathered(lambda body: body.particles.m * (temperatures(body)))
            fields["temperature"] = (heat / mass).astype(np.float32)
        if "stress" in scene.watch.grid:
            fields |= stress_on_nodes(scene, shape, volume)
    return fields


def stress_on_nodes(scene, shape, volume) -> dict[str, np.ndarray]:
    """Recovered Cauchy stress at the nodes inside the domain, a field a component; of several bodies the mean by volume."""
    D, inside = len(shape), tuple(slice(PAD, size - PAD) for size in shape)
    x = np.stack(np.meshgrid(*((np.arange(size) - PAD) * scene.space.h for size in shape), indexing="ij"), axis=-1).reshape(-1, D)
    total = 0.0
    for body in scene.bodies:
        here, a, b = patches(scene.space, body)
        total = total + here[:, None] * (a + np.einsum("nkd,nd->nk", b, x))
    names = components("stress", "axisymmetric" if isinstance(scene.space, Axisymmetric) else D).split()
    turned = [row.reshape(shape)[inside].transpose(*range(D - 1, -1, -1)) / volume for row in np.asarray(total).T]
    return {f"stress_{name}": row.astype(np.float32) for name, row in zip(names, turned, strict=True)}


def axis_names(space) -> tuple[str, ...]:
    return ("r", "z") if isinstance(space, Axisymmetric) else AXES[len(grid_shape(space))]


def motion_of(space, bodies, outlines):
    """Sums and extrema of the motion of some bodies."""
    axes = axis_names(space)
    x, v, m, J, V = (np.concatenate([getattr(body.particles, name).astype(float) for body in bodies]) for name in ("x", "v", "m", "J", "V0"))
    V = V * J
    yield "mass_total", np.sum(m)
    yield "volume_total", np.sum(V)
    for k, axis in enumerate(axes):
        yield f"momentum_{axis}", np.sum(m * v[:, k])
        yield f"position_mean_{axis}", np.sum(m * x[:, k]) / np.sum(m)
    if outlines:
        ends = [moved(outline, body.particles.x, space.h) for outline, body in zip(outlines, bodies, strict=True)]
        low, high = np.min([end.min(axis=0) for end in ends], axis=0), np.max([end.max(axis=0) for end in ends], axis=0)
        for k, axis in enumerate(axes):
            yield from ((f"position_min_{axis}", low[k]), (f"position_max_{axis}", high[k]), (f"extent_{axis}", high[k] - low[k]))
        if isinstance(space, Axisymmetric):
            yield "radius_max", high[0]
    yield "velocity_max", math.sqrt(np.max(np.sum(v * v, axis=1)))
    yield "J_min", np.min(J)
    yield "J_max", np.max(J)
