"""From a validated experiment to a scene of moving bodies: sample shapes, make laws, place surfaces.

Bodies are sampled by cut cells (mpm.scene.cut): one particle a particle cell at the centroid of what the shape fills, so volume, first moment and
surface are right at any offset to the grid. Only what the config names is made.
"""

import math

import numpy as np

from mpm.basis import BASES
from mpm.boundary import extents
from mpm.config.rules_scene import hot
from mpm.config.shapes_fit import home
from mpm.error import Motion
from mpm.materials import Hencky
from mpm.observe import Watch
from mpm.scene.asked import unmet
from mpm.scene.contents import by_nodes
from mpm.scene.conventions import SIDES, STRAINS, spin_tensor
from mpm.scene.course import course
from mpm.scene.exchange import pieces_of, refuse_absent
from mpm.scene.fracture_surface import refuse_idle, surface_and_seams
from mpm.scene.implicit import implicit, kinks
from mpm.scene.inflow import by_owner, inflow, nozzle, sample_column, warmth
from mpm.scene.inflow import moments as openings
from mpm.scene.inventory import ticks
from mpm.scene.law import expansion_law, law, mechanical_laws, setting_law
from mpm.scene.meeting import cornered, meeting, plan_meetings
from mpm.scene.outline import outline_near, outline_of
from mpm.scene.refusal import SceneError
from mpm.scene.scaling import hurried
from mpm.scene.shapes import cells, shape
from mpm.scene.sources import moments, sourced
from mpm.scene.tools import drive
from mpm.scene.total import total_bodies, wall_kinds
from mpm.scene.traction import loaded
from mpm.scene.weight import start
from mpm.simulation import HeatMethod, Scene
from mpm.state import (
    PAD,
    Average,
    Axisymmetric,
    Body,
    GridHeating,
    Heating,
    Isothermal,
    Line,
    NoExchange,
    NoExpansion,
    NoHeating,
    NoRadiation,
    Particles,
    Plane,
    Thermal,
    Volume,
)  # fmt: skip
from mpm.total.drive import begin as begin_nodes
from mpm.transfer import Apic, Bspline, Flip, Mls, Xpic

STILL = Hencky(1e-30, 0.0)  # of a body without `elastic` beside others that move: it is never strained (mpm.contact.held), and limits no step


def output_times(experiment, every: float | None = None) -> np.ndarray:
    """0, every, 2 every, ..., end; `every` is that of the series unless given."""
    end, every = experiment.time.end, every or experiment.output.every
    return np.append(np.arange(ticks(end, every) - 1) * every, end)


def grid_space(experiment):
    """The grid: nodes on the lines of the domain, PAD beyond each face."""
    grid = experiment.grid
    count = [round(size / grid.cell) for size in grid.size]
    for size, n in zip(grid.size, count, strict=True):
        if abs(n * grid.cell - size) > 1e-6 * grid.cell:
            raise SceneError(("grid", "size"), f"{size:g} m is no whole number of cells of {grid.cell:g} m: walls stand on grid lines")
    nodes = [n + 1 + 2 * PAD for n in count]
    kind = {1: Line, 2: Plane, "axisymmetric": Axisymmetric, 3: Volume}[grid.dimension]
    return kind(grid.cell, *nodes, BASES[grid.basis]())


def sample(experiment, name: str, most: float = math.inf):
    """Cut cells of a body in the grid's coordinates, larger where they would be more than `most`; their edges; the outline (mpm.scene.outline)."""
    grid, method = experiment.grid, experiment.method
    outline = shape(experiment.bodies[name].shape, grid.dimension).moved(np.array(method.offset) * grid.cell)
    lower, upper = outline.bounds()
    if grid.dimension == "axisymmetric":
        if method.offset[0] != 0:
            raise SceneError(("method", "offset"), "it shifts an axisymmetric body that moves off its axis: only its second number may differ from 0")
        lower = np.maximum(lower, [0.0, -np.inf])  # a ball on the axis: the other half is the same material
    edge = grid.cell / method.particles
    for low, high, size in zip(lower, upper, grid.size, strict=True):
        if low < -1e-9 * size or high > size * (1 + 1e-9):
            said = f"{name} reaches from {low:g} m to {high:g} m, outside the domain of {size:g} m: move it, or enlarge grid.size"
            raise SceneError(("bodies", name, "shape"), said)
    edge *= max(1, math.ceil((math.prod((upper - lower) / edge) / most) ** (1 / len(lower))))
    edges = [np.arange(math.floor(low / edge + 1e-9), math.ceil(high / edge - 1e-9) + 1) * edge for low, high in zip(lower, upper, strict=True)]
    radial = grid.dimension == "axisymmetric"
    cut = by_nodes(cells(outline, edges, radial), grid.cell)
    return cut, edges, outline_of(outline, cut, edges, radial)


def moving_body(experiment, name: str, zero: float, space, meets: bool, sampled):
    """(Body, its Surroundings or None, its Seams or None, its outline): particles and laws of one body."""
    config = experiment.bodies[name]
    material = experiment.materials[config.material]
    cut, edges, outline = sampled
    faces, cut = cut, cornered(cut, experiment.grid.cell) if meets else cut
    cut = cut if config.inflow is None else by_owner(cut)
    dtype = np.dtype(experiment.method.precision)
    N, D = cut.centroid.shape
    x = cut.centroid
    v, C = np.zeros((N, D)), np.zeros((N, D, D))
    if config.velocity is not None:
        v += config.velocity
    if config.angular_velocity is not None:
        spin = spin_tensor(config.angular_velocity, D)
        v += (x - np.average(x, axis=0, weights=cut.volume)) @ spin.T
        C += spin
    J = np.ones(N)
    arrays = (x, v, C, np.zeros((N, STRAINS[D])), J, material.density * cut.volume, cut.volume)
    particles = Particles(*(np.ascontiguousarray(a, dtype=dtype) for a in arrays))
    elastic, flow = mechanical_laws(material)
    elastic = STILL if elastic is None else elastic
    seams, thermal, surface, expansion, heating, surroundings = None, Isothermal(config.temperature), NoExchange(), NoExpansion(), NoHeating(), None
    if material.heat is not None:
        theta = (np.full(N, config.temperature - zero) if config.inflow is None else warmth(experiment, name, x) - zero).astype(dtype)
        thermal = Thermal(theta, np.zeros((N, D), dtype), zero, law(material.heat.kappa), law(material.heat.alpha))
        surface, surroundings, seams = surface_and_seams(experiment, name, cut, edges, zero, SIDES[experiment.grid.dimension], thermal, meets)
    elif meets:
        surface = pieces_of(cut, np.arange(len(cut.owner)), dtype, NoRadiation())
    if material.expansion is not None:
        expansion = expansion_law(material.expansion, elastic, thermal.theta, zero)
    if material.heating is not None:
        gamma = expansion.gamma if material.heating.elastic is not None else 0.0
        fraction = material.heating.dissipation.fraction if material.heating.dissipation is not None else 0.0
        on_grid = material.heating.elastic is not None and material.heating.elastic.form == "grid"
        heating = GridHeating(gamma, fraction, *np.zeros((2, math.prod(extents(space))))) if on_grid else Heating(gamma, fraction)
    source = sourced(experiment, name, loaded(experiment, name, faces, space, gradient_operator(experiment)), particles, thermal)
    if config.inflow is not None:
        source = nozzle(experiment, name, x)
        particles.v[:] = source.speed[0] * source.way
    setting = setting_law(material, np.full(N, config.temperature))
    body = Body(particles, thermal, surface, elastic, flow, expansion, heating, source, setting=setting)
    return body, surroundings, seams, outline


def schemes(experiment):
    """Transfer of velocity; blend, affine part and XPIC order (0: none) of the transfer of temperature."""
    velocity, temperature = experiment.method.transfer, experiment.method.temperature
    moves = {"apic": lambda _: Apic(), "flip": lambda kind: Flip(kind.blend, 0.0), "pic": lambda _: Flip(1.0, 0.0),
             "affine_flip": lambda kind: Flip(kind.blend, 1.0), "xpic": lambda kind: Xpic(kind.order)}  # fmt: skip
    warms = {"apic": lambda _: (1.0, 1.0, 0), "flip": lambda kind: (kind.blend, 0.0, 0), "pic": lambda _: (1.0, 0.0, 0),
             "affine_flip": lambda kind: (kind.blend, 1.0, 0), "xpic": lambda kind: (0.0, 0.0, kind.order)}  # fmt: skip
    return moves[type(velocity).kind](velocity), *warms[type(temperature).kind](temperature)


def gradient_operator(experiment):
    """The gradient of the particles. On hat functions the MLS gradient is the gradient of the basis: one operator, by its cheaper name."""
    return Mls() if experiment.method.gradient == "mls" and experiment.grid.basis != "linear" else Bspline()


def heat_method(experiment) -> HeatMethod:
    """As the config has it; on hat functions `auto` is implicit: between transfers they bear no explicit step (docs/stability.md, `heat_substeps`)."""
    heat = experiment.method.heat
    kind = type(heat).kind
    if kind == "auto" and experiment.method.mechanics == "implicit":
        return HeatMethod("implicit", 2)
    if kind == "auto" and experiment.grid.basis == "linear":
        return HeatMethod("implicit", 2)
    return HeatMethod(kind, getattr(heat, "order", 1), getattr(heat, "tolerance", HeatMethod.tolerance))


def build(experiment, exact=None, most: float = math.inf, points=None) -> Scene:
    """The scene of one point, its bodies of at most about `most` particles each: fewer to look at, not to run. SceneError where no method can run it.

    points: the cut cells of each body by its name, where they are not those of the grid (mpm.scene.over).
    """
    names = tuple(experiment.bodies)
    refuse_absent(experiment)
    scale, experiment = experiment.time.scale, hurried(experiment)
    space = grid_space(experiment)
    zero = next(iter(experiment.bodies.values())).temperature
    scheme, blend, affine, sharp = schemes(experiment)
    times, references = output_times(experiment), ()
    if experiment.method.frame == "total":
        bodies, references, surroundings = total_bodies(experiment, zero, space)
        meets, seams, walls = None, (None,) * len(names), wall_kinds(experiment)
        outlines = tuple(outline_near(experiment, name, body.particles.x) for name, body in zip(names, bodies, strict=True))
    else:
        meets = plan_meetings(experiment, SIDES[experiment.grid.dimension])
        found = ((sample if body.inflow is None else sample_column)(experiment, name, most) for name, body in experiment.bodies.items())
        sampled = found if points is None else ((points[name], None, None) for name in names)
        made = (moving_body(experiment, name, zero, space, met, one) for name, met, one in zip(names, meets.any, sampled, strict=True))
        bodies, surroundings, seams, outlines = zip(*made, strict=True)
        walls = meets.walls.min(axis=0)
        refuse_idle(experiment, seams)
    never = unmet(experiment, meets, SIDES[experiment.grid.dimension])
    if getattr(exact, "starts", False):
        begin(bodies, exact, zero, space.h)
    if experiment.method.locking is not None:
        own = float(experiment.method.locking.own)
        bodies = tuple(body._replace(locking=Average(*np.zeros((2, math.prod(extents(space)))), own)) for body in bodies)
    if isinstance(exact, Motion):
        first, exact = exact.begin(bodies[0])
        bodies = (first, *bodies[1:])
    for body, reference in zip(bodies, references, strict=False):
        begin_nodes(space, body, reference)
    met = None if meets is None else meeting(meets, space, bodies, surroundings, names, SIDES[experiment.grid.dimension], drive(experiment))
    for body, around in zip(bodies, surroundings, strict=True):
        if around is not None:
            around.write(space, body, 0.0, 0.0)
    changes = course(experiment, met, walls, bodies, references)
    return Scene(
        space=space,
        gradient=gradient_operator(experiment),
        scheme=scheme,
        names=names,
        bodies=bodies,
        surroundings=surroundings,
        hot=tuple(name for _, name in hot(experiment)),
        seams=seams,
        references=references,
        outlines=outlines,
        walls=walls,
        meeting=met,
        course=changes,
        gravity=np.array([start(experiment)]),
        blend=blend,
        affine=affine,
        sharp=sharp,
        repair=type(experiment.method.bounds).kind != "free" and not references,
        tears=experiment.method.fracture == "fail",
        times=times,
        step=None if experiment.time.step == "auto" else experiment.time.step,
        safety=experiment.time.safety,
        heat_step=None if experiment.method.heat_step == "auto" else experiment.method.heat_step,
        heat=heat_method(experiment),
        scale=scale,
        inflow=inflow(experiment, bodies),
        turns=(*moments(experiment), *openings(experiment), *(changes.turns if changes is not None else ()), *kinks(experiment, met)),
        implicit=implicit(experiment, space, bodies, references, met, times),
        watch=watch(experiment, exact, never),
    )


def begin(bodies, exact, zero: float, h: float) -> None:
    """Temperatures and their gradients at the start from exact(x, 0); the gradient by central differences over h/1000."""
    for body in bodies:
        x, D = body.particles.x.astype(float), body.particles.x.shape[1]
        body.thermal.theta[:] = exact(x, 0.0) - zero
        for k in range(D):
            step = np.zeros(D)
            step[k] = 1e-3 * h
            body.thermal.c[:, k] = (exact(x + step, 0.0) - exact(x - step, 0.0)) / (2e-3 * h)


def watch(experiment, exact=None, unmet: tuple[str, ...] = ()) -> Watch:
    """What the config asks to record."""
    from mpm.records.variables import BITES, dataset_name, met, probed, single, threshold

    shift = np.array(experiment.method.offset) * experiment.grid.cell
    found = [(dataset_name(name), threshold(name)) for name in experiment.output.observables if threshold(name) is not None]
    snapshots = experiment.output.snapshots
    return Watch(
        probes={name: np.array(x) + shift for name, x in experiment.output.probes.items()},
        homes={name: home(experiment.bodies, x, experiment.grid.size) for name, x in experiment.output.probes.items()},
        asked={dataset_name(name): one for name in experiment.output.observables if (one := probed(name)) is not None},
        of={dataset_name(name): (one[0], list(experiment.bodies).index(one[1])) for name in experiment.output.observables if (one := single(name)) is not None},
        unmet=dict.fromkeys(unmet, 0.0),
        bites={dataset_name(name): one[:2] for name in experiment.output.observables if (one := met(name)) is not None and one[0] in BITES},
        thresholds=[(name, at.probe, at.kelvin) for name, at in found],
        snapshots=output_times(experiment, snapshots.every) if snapshots else np.zeros(0),
        grid=snapshots.grid if snapshots else (),
        particles=tuple(dict.fromkeys((*snapshots.particles, "body", "id"))) if snapshots and snapshots.particles else (),
        exact=exact,
    )
