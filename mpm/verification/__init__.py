"""Problems with exact solutions: a file each. `exact(experiment) -> theta(x (N, D), t)` of the scene that a config sets up;
for a material point (grid.dimension 0) `exact(experiment) -> solution(times) -> {series: values}`;
for a moving body `exact(experiment) -> Motion` (mpm.error): its fields by material point, and what it starts from.

To add    a file with `exact`, its kind in config.output, a line in EXACT; a config that names it under configs/verification/.

Further files
    adiabatic            adiabatic compression of a thermoelastic point
    cantilever           a cantilever at rest under its own weight, by finite elements
    cooks_membrane       Cook's membrane
    formulas             A manufactured problem that the config poses
    free_fall            flight under gravity
    gaussian_box         A Gaussian that spreads in an insulated box, by images
    heated_slab          A slab heated evenly from within that cools through one face or both
    hencky_bar           A bar of Hencky material in uniaxial strain that starts straight in its first mode
    hertz                a ball between a floor and a plate
    hydrostatic_column   A column of Hencky material under its own weight, in uniaxial strain and at rest
    layers               layers in contact, slabs or coaxial cylinders
    lumped_cooling       A rigid body of one temperature that cools through its surface
    manufactured         A manufactured thermoelastic motion in 1-D and plane strain
    nafems_t3            A bar between a fixed end and one that follows a sine (NAFEMS benchmark T3)
    nafems_t4            A plate in steady state
    path                 the prescribed history of a material point as functions of time
    pressed_cylinder     a thick cylinder under pressures inside and outside, at rest
    relaxation           stress relaxation of a viscoplastic point at held strain, from a state outside the ellipse
    rheometer            reading M, p0 and eta from a compression test, as from a rheometer's curve
    rigid_rotation       steady rotation with translation
    robin_cylinder       A long cylinder, or a disc in plane strain, that cools through its side
    robin_ring           A hollow cylinder that cools inside and outside alike (Carslaw & Jaeger 1959, 13.4)
    robin_slab           A slab that cools through both faces, or through one face with the other insulated (Carslaw & Jaeger 1959, 3.11)
    robin_sphere         A sphere that cools through its surface (Carslaw & Jaeger 1959, 9.4)
    setup                what the exact solutions need to know of a scene, and refusals where the scene is not their problem
    shear_heating        adiabatic heating of a point that is sheared past its yield stress
    spinning_disc        an elastic disc that turns freely: it widens and breathes
    standing_wave        A linear thermoelastic wave between insulated walls
    stefan               melting of a half space behind a hot face
    thermal_cylinder     a thick cylinder between two temperatures, at rest
    thermal_shock        a slab that is cooled at once, held across and free along
    traction_bar         a bar that is pulled at its end until it rests
    thermal_expansion    thermal expansion of an elastic point, free in n of its three directions and held in the others
"""

from mpm.scene.refusal import SceneError
from mpm.verification import (
    adiabatic,
    cantilever,
    cooks_membrane,
    formulas,
    free_fall,
    gaussian_box,
    heated_slab,
    hencky_bar,
    hertz,
    hydrostatic_column,
    layers,
    lumped_cooling,
    manufactured,
    nafems_t3,
    nafems_t4,
    pressed_cylinder,
    relaxation,
    rigid_rotation,
    robin_cylinder,
    robin_ring,
    robin_slab,
    robin_sphere,
    shear_heating,
    spinning_disc,
    standing_wave,
    stefan,
    thermal_cylinder,
    thermal_expansion,
    thermal_shock,
    traction_bar,
)

EXACT = {
    "robin_slab": robin_slab.exact,
    "robin_cylinder": robin_cylinder.exact,
    "robin_sphere": robin_sphere.exact,
    "adiabatic": adiabatic.exact,
    "thermal_expansion": thermal_expansion.exact,
    "relaxation": relaxation.exact,
    "shear_heating": shear_heating.exact,
    "lumped_cooling": lumped_cooling.exact,
    "robin_ring": robin_ring.exact,
    "hencky_bar": hencky_bar.exact,
    "standing_wave": standing_wave.exact,
    "rigid_rotation": rigid_rotation.exact,
    "free_fall": free_fall.exact,
    "hydrostatic_column": hydrostatic_column.exact,
    "manufactured": manufactured.exact,
    "nafems_t3": nafems_t3.exact,
    "nafems_t4": nafems_t4.exact,
    "gaussian_box": gaussian_box.exact,
    "stefan": stefan.exact,
    "layers": layers.exact,
    "heated_slab": heated_slab.exact,
    "formulas": formulas.exact,
    "cooks_membrane": cooks_membrane.exact,
    "cantilever": cantilever.exact,
    "traction_bar": traction_bar.exact,
    "thermal_shock": thermal_shock.exact,
    "thermal_cylinder": thermal_cylinder.exact,
    "hertz": hertz.exact,
    "pressed_cylinder": pressed_cylinder.exact,
    "spinning_disc": spinning_disc.exact,
}

LOADED = (
    "cooks_membrane",
    "cantilever",
    "traction_bar",
    "thermal_shock",
    "thermal_cylinder",
    "hertz",
    "pressed_cylinder",
)  # scenes that have loads of their own
SOURCED = ("heated_slab", "formulas")  # and sources


def exact_solution(experiment):
    """The solution that the config names, or None. SceneError where the scene is not the problem."""
    if experiment.exact is None:
        return None
    try:
        return fitting(experiment, type(experiment.exact).kind)
    except ValueError as why:
        raise SceneError(("exact",), f"{why}; take `exact` out, or make the scene its problem") from None


def fitting(experiment, kind: str):
    """The solution of that kind; ValueError says what of the scene does not fit it."""
    for name, material in experiment.materials.items():
        E = material.elastic.E if material.elastic is not None else None
        if E is not None and type(E).kind != "constant":
            raise ValueError(f"{kind} needs a constant E, not the {type(E).kind} of {name}")
    if experiment.loads and kind not in LOADED:
        raise ValueError(f"{kind} is a scene without loads")
    if experiment.sources and kind not in SOURCED:
        raise ValueError(f"{kind} is a scene without sources")
    return EXACT[kind](experiment)
