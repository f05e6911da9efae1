"""Robin exchange of particles that fly across the grid at Bi = 10, as the shipped configs have it: order 1.8 or better, below 2e-4 at 64 cells a radius."""

import pytest


@pytest.mark.parametrize("name", ["robin_slab_particles", *(pytest.param(f"robin_{body}_particles", marks=pytest.mark.slow) for body in ("cylinder", "disc"))])
def test_order_and_error_at_64_cells(core, points, name):
    errors = [run.finals["error_l2"] for run in points(name, "grid.cell", (1 / 16, 1 / 32, 1 / 64))]
    assert core.order(errors) > 1.8 and errors[-1] < 2e-4


def test_xpic_behind_a_surface(core, points):
    """With slopes beside it: 2.7e-2 at 16 cells without them, and of order 1."""
    errors = [run.finals["error_l2"] for run in points("robin_slab_particles", "grid.cell", (1 / 16, 1 / 32), {"method.temperature": "xpic"})]
    assert core.order(errors) > 1.8 and errors[-1] < 4e-4
