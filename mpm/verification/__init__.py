"""Problems with exact solutions: a file each. `exact(experiment) -> theta(x (N, D), t)` of the scene that a config sets up;
for a material point (grid.dimension 0) `exact(experiment) -> solution(times) -> {series: values}`;
for a moving body `exact(experiment) -> Motion` (mpm.error): its fields by material point, and what it starts from.

To add    a file with `exact`, its kind in config.output, a line in EXACT; a config that names it under configs/verification/.
"""

from mpm.scene.refusal import SceneError
from mpm.verification import (
    adiabatic,
    cooks_membrane,
    free_fall,
    gaussian_box,
    hencky_bar,
    hydrostatic_column,
    layers,
    lumped_cooling,
    manufactured,
    nafems_t3,
    nafems_t4,
    relaxation,
    rigid_rotation,
    robin_cylinder,
    robin_ring,
    robin_slab,
    robin_sphere,
    shear_heating,
    standing_wave,
    stefan,
    thermal_expansion,
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
    "cooks_membrane": cooks_membrane.exact,
}

LOADED = ("cooks_membrane",)  # scenes that have loads of their own


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
    return EXACT[kind](experiment)
