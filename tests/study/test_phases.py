"""`mpm bench CONFIG` of a scene without particles: its parts make the whole, and what it exchanges heat by is told apart."""

import mpm
from mpm.study.phases import rigid, table


def test_a_scene_at_rest_is_told_by_phase_and_physics():
    scene = {
        "grid": {"dimension": 0},
        "bodies": {"cube": {"shape": {"point": {"surface_to_volume": 60}}, "temperature": 350, "material": "m"}},
        "materials": {"m": {"density": 1000, "heat": {"fourier": {"kappa": 1.0, "alpha": 1000}}}},
        "surfaces": [{"of": "cube", "convection": {"beta": 20, "outside": 300}}],
        "time": {"end": 10, "step": 1},
    }
    steps, found = mpm.run_point(mpm.load(scene)).steps, rigid(mpm.load(scene))
    assert 0 < found["setup_s"] <= found["point_s"] and found["steps"] == steps and set(found["without_s"]) <= {"exchange"}
    said = table(found)
    assert f"to set up, {steps} steps of" in said and ("without exchange" in said) == bool(found["without_s"])
