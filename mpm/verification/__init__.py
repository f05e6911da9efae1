"""Problems with exact solutions: a file each. `exact(experiment) -> theta(x (N, D), t)` of the scene that a config sets up;
for a material point (grid.dimension 0) `exact(experiment) -> solution(times) -> {series: values}`.

To add    a file with `exact`, its kind in config.output, a line in EXACT; a config that names it under configs/verification/.
"""

from mpm.verification import (
    adiabatic,
    gaussian_box,
    lumped_cooling,
    nafems_t3,
    nafems_t4,
    relaxation,
    robin_cylinder,
    robin_slab,
    shear_heating,
    stefan,
    thermal_expansion,
)

EXACT = {
    "robin_slab": robin_slab.exact,
    "robin_cylinder": robin_cylinder.exact,
    "adiabatic": adiabatic.exact,
    "thermal_expansion": thermal_expansion.exact,
    "relaxation": relaxation.exact,
    "shear_heating": shear_heating.exact,
    "lumped_cooling": lumped_cooling.exact,
    "nafems_t3": nafems_t3.exact,
    "nafems_t4": nafems_t4.exact,
    "gaussian_box": gaussian_box.exact,
    "stefan": stefan.exact,
}


def exact_solution(experiment):
    """The solution that the config names, or None. ValueError where the scene is not the problem."""
    if experiment.exact is None:
        return None
    return EXACT[type(experiment.exact).kind](experiment)
