"""A cantilever that is charted and planned for, with its answer by finite elements."""

import mpm

TIP = -1.0259e-3  # m, tests/total/finite_elements.py: -1.02394e-3, -1.02520e-3, -1.02566e-3 with 20 x 4, 40 x 8, 80 x 16 elements, to their limit


def beam(**changes):
    """A cantilever that bends by a thousandth of its length: 0.2 high, E = 1e6, under R0 g = 29, at rest."""
    return mpm.load({
        "grid": {"dimension": 2, "size": [1.2, 0.8], "cell": 0.1}, "materials": {"m": {"density": 1, "elastic": {"hencky": {"E": 1e6, "nu": 0.3}}}},
        "bodies": {"beam": {"shape": {"box": {"lower": [0, 0.4], "upper": [1, 0.6]}}, "material": "m"}}, "walls": {"left": "stick"},
        "gravity": [0, -29.0], "loads": [{"of": "beam", "drag": {"rate": 425}}], "time": {"end": 0.12}, "method": {"frame": "total"},
        "output": {"every": 0.02, "probes": {"tip": [1, 0.5]}, "observables": ["displacement.tip_y", "position.mean_y"]},
    }, changes)  # fmt: skip


FAR = -0.5041  # m, as mpm/verification/cantilever.py has it


def far(**changes):
    """A cantilever that bends by half its length: 0.1 high, under R0 g = 4578.75, at rest."""
    return beam(**{"grid.size": [1.2, 1.3], "bodies.beam.shape": {"box": {"lower": [0, 1.1], "upper": [1, 1.2]}}, "gravity": [0, -4578.75], "time.end": 0.2,
                   "loads.0.drag.rate": 212, "output.every": 0.05, "output.probes.tip": [1, 1.15]} | changes)  # fmt: skip
