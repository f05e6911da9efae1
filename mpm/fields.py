"""Fields of snapshots: of the grid, and of particles: one function a name, of the scene, the body and where its particles were at the start.

Tensors have a column a component, in the order of mpm.state (mpm.records.variables.components).
stress              Cauchy [Pa];   strain: elastic Hencky strain, 1/2 log of F_e F_e^T [-], the thermal part included
displacement        x - X in both frames;   reference_position X;   id: the same number in every snapshot
velocity_gradient   grad v [1/s], rows of v: of the nodes in the total frame, the slopes that affine transfers carry in the updated one
"""

import math

import numpy as np

from mpm.boundary import extents
from mpm.diagnostics import grid_shape, nodal, strains, stresses, temperatures, thermal_pressure
from mpm.error import PLACES, kirchhoff
from mpm.heat.setting import conditions
from mpm.state import PAD, Axisymmetric, Setting

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
            fields[name] = np.arange(sum(len(body.particles.m) for body in scene.bodies), dtype=np.int32)
        else:
            fields[name] = np.concatenate([np.array(made[name](body, X)) for body, X in zip(scene.bodies, origins, strict=True)])
    return fields


def cauchy(body) -> np.ndarray:
    """Cauchy stress (N, K) [Pa]."""
    return kirchhoff(body) / body.particles.J[:, None].astype(float)


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
    return fields


def axis_names(space) -> tuple[str, ...]:
    return ("r", "z") if isinstance(space, Axisymmetric) else AXES[len(grid_shape(space))]
