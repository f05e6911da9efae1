"""What a scene is made of: named tuples of arrays, with only the fields that the scene's physics names.

Absence is an object: a body without heat carries `Isothermal()`, and nothing of heat is stored, compiled or computed.
Layouts   D directions of the grid, N particles, K strain components: line xx yy zz; plane xx yy zz xy; volume xx yy zz xy yz xz
"""

from typing import Any, NamedTuple

import numpy as np

PAD = 2  # nodes outside each face of the domain: one that the basis reaches, one to notice a leaver


class Linear(NamedTuple):
    """Hat functions: two nodes a direction (mpm.basis.linear)."""


class Quadratic(NamedTuple):
    """Quadratic B-splines: three nodes a direction (mpm.basis.quadratic)."""


class Cubic(NamedTuple):
    """Cubic B-splines: four nodes a direction (mpm.basis.cubic)."""


class Line(NamedTuple):
    """One direction: uniaxial strain. Node i of an array lies at (i - PAD) h."""

    h: float
    n0: int
    basis: Any = Quadratic()


class Plane(NamedTuple):
    """Two directions x, y: plane strain."""

    h: float
    n0: int
    n1: int
    basis: Any = Quadratic()


class Axisymmetric(NamedTuple):
    """Two directions r, z; everything per radian."""

    h: float
    n0: int
    n1: int
    basis: Any = Quadratic()


class Volume(NamedTuple):
    """Three directions x, y, z."""

    h: float
    n0: int
    n1: int
    n2: int
    basis: Any = Quadratic()


class Particles(NamedTuple):
    """Mechanical state of one body."""

    x: np.ndarray  # (N, D) position [m]
    v: np.ndarray  # (N, D) velocity [m/s]
    C: np.ndarray  # (N, D, D) affine velocity [1/s]
    B: np.ndarray  # (N, K) elastic left Cauchy-Green tensor less the identity [-]
    J: np.ndarray  # (N,) total volume ratio [-]
    m: np.ndarray  # (N,) mass [kg]
    V0: np.ndarray  # (N,) reference volume [m^D, axisymmetric m^3 per radian]


class Thermal(NamedTuple):
    """Thermal state of one body. Temperatures are stored less `zero`, so that float32 keeps small changes."""

    theta: np.ndarray  # (N,) temperature less zero [K]
    c: np.ndarray  # (N, D) affine part: temperature gradient [K/m]
    zero: float  # [K]
    kappa: Any  # law [W/(m K)]
    alpha: Any  # law [J/(kg K)]


class NoExposure(NamedTuple):
    """Nobody asks what each wall and tool gave."""


class Exposure(NamedTuple):
    """What each piece saw in one heat step, so that the heat of each wall and tool is known after it (integrate/surroundings.py): integrals over time and
    area, weighted as the step weights its stages.
    """

    area: np.ndarray  # (S,) of 1 [m^(D-1) s]
    theta: np.ndarray  # (S,) of the piece's temperature less zero [K m^(D-1) s]
    part: np.ndarray  # (S,) of the share of the heat step that is gone [m^(D-1) s]


class Surface(NamedTuple):
    """Pieces of a body's surface that exchange heat, each at an offset from its particle (docs/physics.md 11).
    What surrounds them (`beta` to `radiation`) and `exposure` hold for one heat step: integrate/surroundings.py writes it where it changes in time or place.
    """

    F: np.ndarray  # (R, D, D) total deformation gradient, in the grid's directions, of the particles that own pieces: carries areas and offsets (Nanson)
    row: np.ndarray  # (N,) which of them a particle is; -1: it owns no piece
    owner: np.ndarray  # (S,) particle
    area: np.ndarray  # (S, D) reference area times outward normal
    offset: np.ndarray  # (S, D) reference offset from particle to the piece's centroid [m]
    beta: np.ndarray  # (S,) [W/(m2 K)]
    outside: np.ndarray  # (S,) ambient temperature less zero at the start of the heat step [K]
    drift: np.ndarray  # (S,) its change over the heat step [K]
    flux: np.ndarray  # (S,) heat into the body [W/m2]
    radiation: Any  # Radiation or NoRadiation
    exposure: Any = NoExposure()  # or Exposure


class Radiation(NamedTuple):
    """Grey exchange with surroundings that enclose the body: sigma emissivity (Theta^4 - sky^4)."""

    emissivity: np.ndarray  # (S,) [-]
    sky: np.ndarray  # (S,) temperature of the surroundings at the start of the heat step [K]
    drift: np.ndarray  # (S,) its change over the heat step [K]


class NoRadiation(NamedTuple):
    """Nothing radiates."""


class Isothermal(NamedTuple):
    """No heat: laws of temperature are taken at this one [K]."""

    temperature: float


class NoExchange(NamedTuple):
    """No surface exchanges heat: none is stored, and F is not carried."""


class NoExpansion(NamedTuple):
    """No thermal stress."""


class Expansion(NamedTuple):
    """Thermal stress -gamma (Theta - reference) 1."""

    gamma: float  # [Pa/K]
    shift: float  # zero - reference [K]: theta + shift = Theta - Theta_0


class Latched(NamedTuple):
    """Thermal stress -gamma (min(highest Theta so far, set) - reference) 1: swells as it warms, and keeps that as it cools (docs/physics.md 10)."""

    gamma: float  # [Pa/K]
    shift: float  # zero - reference [K]
    most: np.ndarray  # (N,) highest temperature so far, at most `set`, less zero [K]
    set: float  # temperature at which it sets, less zero [K]


class Softening(NamedTuple):
    """Thermal stress of moduli that follow temperature: that of `inner`, whose gamma is for E = 1 Pa, times E(Theta)."""

    inner: Any  # Expansion or Latched [1/K]
    E: Any  # law of temperature [Pa]


class NoSetting(NamedTuple):
    """Nothing sets: laws follow temperature alone."""


class Setting(NamedTuple):
    """Degrees of setting (docs/physics.md 18), in double precision: an explicit step adds less than single precision sees."""

    X: np.ndarray  # (N,) from 0 to 1 [-]
    k: np.ndarray  # (N,) rate at the temperature of the last step [1/s]
    rate: Any  # law of temperature [1/s]


class NoHeating(NamedTuple):
    """Deformation does not heat."""


class Heating(NamedTuple):
    """Elastic heating along the adiabat and the share of dissipation that becomes heat (docs/physics.md 4, step 7)."""

    gamma: float  # stress-temperature modulus, zero where elastic heating is not named [Pa/K]
    fraction: float  # chi_d, zero where dissipation heating is not named [-]


class GridHeating(NamedTuple):
    """Elastic heating as a term of the heat equation on the grid (integrate/grid_heating.py), and the share of dissipation that becomes heat."""

    gamma: float  # stress-temperature modulus [Pa/K]
    fraction: float  # chi_d, zero where dissipation heating is not named [-]
    capacity: np.ndarray  # (n,) scratch of one step [J/K]
    rise: np.ndarray  # (n,) scratch of one step: heat [J], then rise [K]


class NoSource(NamedTuple):
    """Nothing but gravity, walls and surroundings acts on a body."""


class Source(NamedTuple):
    """A force and a heat source that a law gives at every particle, over time (integrate/body_force.py)."""

    X: np.ndarray  # (N, D) position at the start [m]
    t: np.ndarray  # (N,) time of the particle [s]
    law: Any


class Ramp(NamedTuple):
    """A load that acts from the start to the end."""

    time: float  # to full load [s]


class Within(NamedTuple):
    """A load that begins or ends within the run."""

    time: float  # to full load from the beginning on [s]
    begin: float  # [s]
    end: float  # [s]
    past: np.ndarray  # (1,) share of the first impulse of a block of steps that acts before the block (mpm.contact.course)


class Load(NamedTuple):
    """Tractions on parts of a body's surface, and a drag (integrate/traction.py)."""

    force: np.ndarray  # (N, D) at full load [N]
    dipole: np.ndarray  # (N, D, D) sum over pieces of force times offset from the particle, in the reference state [N m]
    F: np.ndarray  # (N, D, D) deformation gradient of the particles that carry a force
    loaded: np.ndarray  # (N,) whether a particle carries a force
    t: np.ndarray  # (N,) time of the particle [s]
    ramp: Any  # Ramp or Within
    rate: float  # drag: -rate m v [1/s]
    scale: float  # of chunk.S: 1, or 1/(sum w d^2) with the MLS gradient [1, 1/m2]
    area: Any  # mpm.integrate.traction: Nominal or Present
    left: float = 0.0  # at pieces of surface: mpm.integrate.traction BORNE, GROWS or ROUGH


class NoAverage(NamedTuple):
    """Each particle keeps its own change of volume."""


class Average(NamedTuple):
    """Changes of volume averaged over the grid (integrate/fbar.py): scratch of one step, and how much of its own change a particle keeps."""

    change: np.ndarray  # (n,) volume change of a step [-]
    volume: np.ndarray  # (n,) [m^D]
    own: float  # [-]


class Body(NamedTuple):
    """One body: a contiguous set of particles with one law each."""

    particles: Particles
    thermal: Any  # Thermal or Isothermal
    surface: Any  # Surface or NoExchange
    elastic: Any
    flow: Any
    expansion: Any
    heating: Any
    source: Any = NoSource()
    locking: Any = NoAverage()  # or Average
    setting: Any = NoSetting()  # or Setting


class Unread(NamedTuple):
    """Stands for a law that a compiled step does not read."""


def as_moved(bodies: tuple) -> tuple:
    """Bodies as the mechanical step reads them: those that conduct or radiate differently share one compiled step."""
    return tuple(
        body._replace(
            thermal=body.thermal._replace(kappa=Unread()) if isinstance(body.thermal, Thermal) else body.thermal,
            surface=body.surface._replace(radiation=NoRadiation(), exposure=NoExposure()) if isinstance(body.surface, Surface) else body.surface,
        )
        for body in bodies
    )


def as_heated(body: Body) -> Body:
    """A body as the heat step reads it: those that move differently share one compiled step."""
    return Body(body.particles, body.thermal, body.surface, *[Unread()] * (len(Body._fields) - 3))


PER_PARTICLE = {  # arrays with a row a particle: they move together when particles are sorted (integrate/sorting.py)
    Particles: Particles._fields,
    Thermal: ("theta", "c"),
    Surface: ("row",),
    Latched: ("most",),
    Setting: ("X", "k"),
    Source: ("X", "t"),
    Load: ("force", "dipole", "F", "loaded", "t"),
}
