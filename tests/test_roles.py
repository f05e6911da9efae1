"""Compiled equals plain Python, for the whole step of every dimension and transfer, and every sibling of every role is run by it.

The same scenes run here, compiled, and in a process with NUMBA_DISABLE_JIT=1, which also says which functions it entered.
"""

import functools
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parent.parent
AIR = [{"of": "body", "convection": {"beta": 0.5, "outside": 300.0}}]
KEEP = ("x", "v", "C", "B", "J")


MLS, BSPLINE = ("apic", "mls"), ("flip", "bspline")
FLIGHTS = [(dimension, *MLS) for dimension in (1, 2, "axisymmetric", 3)] + [(2, *BSPLINE)]
MORE = [(dimension, *BSPLINE) for dimension in (1, "axisymmetric", 3)]
QUICK = ("2 apic mls", "1 implicit", "bare")


def flights(chosen):
    """Name -> config of bodies that fly, turn and cool."""
    common = config_of()
    for dimension, transfer, gradient in chosen:
        data = common.config(dimension, surfaces=AIR, method=common.methods(transfer, gradient) | {"heat_step": 0.05, "particles": 1})
        data["materials"]["solid"]["expansion"]["modulus"]["gamma"] = 0.01
        data["time"] = {"end": 0.1, "step": 0.025}
        yield f"{dimension} {transfer} {gradient}", data


def scenes():
    """Small and full of physics: name -> config. The kinds are those that other tests compile too."""
    common = config_of()
    yield from flights(FLIGHTS)
    for name, heat in (("1 implicit", {"implicit": {}}), ("1 second order", {"implicit": {"order": 2}})):
        data = common.config(1, surfaces=AIR, method={"heat": heat, "heat_step": 0.05}, time={"end": 0.1, "step": 0.025})
        yield name, data
    for name, heat in (("1 latent", {"implicit": {"order": 2}}), ("1 latent stabilised", {"stabilised": {}}), ("1 latent explicit", {"explicit": {}})):
        data = common.config(1, surfaces=AIR, method={"heat": heat, "heat_step": 0.05}, time={"end": 0.1, "step": 0.025})
        data["materials"]["solid"]["heat"]["fourier"]["alpha"] = {"bump": {"base": 1.5, "heat": 20.0, "at": 399.0, "width": 0.5}}
        yield name, data
    bare = common.config(1, surfaces=[], time={"end": 0.1, "step": 0.025})
    bare["materials"]["solid"] = {"density": 2.0, "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}}}
    bare["walls"] = {"left": "contact", "right": "stick"}
    yield "bare", bare
    two = common.config(1, surfaces=AIR, method={"heat_step": 0.05}, time={"end": 0.1, "step": 0.025}, grid={"dimension": 1, "size": [4.0], "cell": 0.25})
    two["bodies"]["other"] = {"shape": {"box": {"lower": [2.6], "upper": [3.2]}}, "material": "rubber", "velocity": [0.1]}
    two["materials"]["rubber"] = {"density": 1.0, "elastic": {"hencky": {"lam": 1.0, "mu": 1.0}}}
    yield "two bodies", two


def config_of():
    """The helpers of conftest.py, also where pytest does not run."""
    import importlib.util

    spec = importlib.util.spec_from_file_location("common", Path(__file__).parent / "conftest.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def stir(scene):
    p = scene.bodies[0].particles
    rates = 0.3 * np.diag([0.9, -0.6, 0.7][: p.x.shape[1]])
    p.v[:], p.C[:] = (p.x - 0.1) @ rates, rates


def results(chosen):
    """Arrays of every scene at its end, as lists."""
    import mpm

    common, found = config_of(), {}
    for name, data in chosen:
        scene, run = common.play(mpm.load(data), stir)
        body = scene.bodies[0]
        found[name] = {field: getattr(body.particles, field).tolist() for field in KEEP} | {"series": {k: v.tolist() for k, v in run.series.items()}}
        found[name]["others"] = {f"{k}": other.particles.x.tolist() for k, other in enumerate(scene.bodies[1:])}
        found[name]["outcome"] = str(run.outcome)
        if hasattr(body.thermal, "theta"):
            found[name] |= {"theta": body.thermal.theta.tolist(), "c": body.thermal.c.tolist()}
    return found


def registered():
    """{role.kind: (role, kind, function)} of all that a role of the rooms of a step may choose."""
    import mpm.simulation  # noqa: F401  imports the rooms

    found = {}
    for room, module in list(sys.modules.items()):
        if room.startswith(("mpm.transfer", "mpm.boundary", "mpm.heat", "mpm.integrate", "mpm.diagnostics")):
            for name, role in vars(module).items():
                if hasattr(role, "registry") and hasattr(role, "dispatch") and role.__module__ == room:
                    found |= {f"{name}({kind.__name__})": (role, kind, function) for kind, function in role.registry.items() if kind is not object}
    return found


def noting(function, entered):
    @functools.wraps(function)
    def noted(*arguments):
        entered.add(function)
        return function(*arguments)

    return noted


def in_plain_python():
    """Run without compilation, and note which functions of roles were entered."""
    entered, roles = set(), registered()
    for role, kind, function in roles.values():
        role.register(kind, noting(function, entered))
    found = results((*scenes(), *flights(MORE)))
    print(json.dumps({"results": found, "missed": [name for name, (_, _, function) in roles.items() if function not in entered]}))


@pytest.fixture(scope="module")
def plain():
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, __file__], cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout)


def compare(compiled, other, place):
    if isinstance(compiled, dict):
        assert compiled.keys() == other.keys()
        for name in compiled:
            compare(compiled[name], other[name], f"{place}.{name}")
    elif isinstance(compiled, str):
        assert compiled == other, place
    else:
        a, b = np.array(compiled, float), np.array(other, float)
        # theta is a small difference of temperatures of 400 K, hence the absolute part.
        assert np.allclose(a, b, rtol=1e-10, atol=1e-11 * max(1.0, np.abs(a).max(initial=0.0))), f"{place}: {np.abs(a - b).max():.3g}"


def held_together(found, plain):
    compare(found, {name: plain["results"][name] for name in found}, "")


def test_compiled_equals_plain_python(plain):
    held_together(results((name, data) for name, data in scenes() if name in QUICK), plain)


@pytest.mark.wide
def test_compiled_equals_plain_python_of_every_scene(plain):
    held_together(results((name, data) for name, data in scenes() if name not in QUICK), plain)


@pytest.mark.slow
def test_compiled_equals_plain_python_of_flip_in_every_dimension(plain):
    held_together(results(flights(MORE)), plain)


# Siblings that would cost a compilation each: slow tests, or tests of their own rooms, run them compiled. A new one is named here or gets a scene.
ELSEWHERE = {
    "impulse_parts(Mls)", "carry(Xpic)", "wants_change(Xpic)", "sharpen(Xpic)", "what_is_lost(Isothermal)", "what_is_lost(Thermal)",
    "nodes_of(Plane)", "nodes_of(Axisymmetric)", "nodes_of(Volume)", "advance_heat(Isothermal)", "advance_implicit(Isothermal)",
    "meet(NoExchange)", "place(NoExchange)", "radiate(Radiation)", "rise(Bump)", "rise(Logistic)", "rise(Table)",
    "rises(Bump)", "rises(Logistic)", "rises(Table)", "heat_eight(NoHeating)", "heat_eight(GridHeating)", "grow_warmer(Isothermal)",  # tests/heat/test_lanes.py
    "thermal_stress(Latched)", "latch(Latched)", "flows(EllipseClipped)", "flows(EllipseRadial)",
    "act(Source)", "take_up(Isothermal)", "take_up(Thermal)",  # tests/verification/test_manufactured.py
    "thermal_stress(Softening)", "latch(Softening)",  # tests/point/test_laws.py
    "heat_locally(GridHeating)", "compress(GridHeating)",  # tests/integrate/test_grid_heating.py
    "divergence(Line)", "divergence(Plane)", "divergence(Axisymmetric)", "divergence(Volume)",  # the same
    "act(Given)", "act(Both)", "warm(Warming)", "warm(NoWarming)", "push_at(Force)", "push_at(NoForce)",  # tests/verification/test_sources.py
    "expose(NoExchange)", "expose_pieces(Exposure)",  # tests/contact/test_heat_of_tools.py
    "hold(Held)",  # tests/contact/test_held.py
    "push_at(Jumping)", *(f"mix_past({force})" for force in ("Force", "NoForce", "Jumping")),  # tests/contact/test_course.py
    "act(Load)", "turn(Nominal)", "turn(Present)",  # tests/total/test_present_area.py
    *(f"{role}({course})" for role in ("share", "within", "opening") for course in ("Ramp", "Within")),  # tests/integrate/test_traction.py
    "advance_heat(Thermal)", "advance_stabilised(Isothermal)",  # tests/heat/test_exchange_kinds.py
    "stress_plane(NeoHookean)", "stress_volume(NeoHookean)",  # tests/integrate/test_neo_hookean.py
    "scatter_by_basis(Linear)", "scatter_by_basis(Cubic)", "gather_by_basis(Linear)", "gather_by_basis(Cubic)",  # tests/test_bases.py
    *(f"{role}({space})" for role in ("take", "give") for space in ("Line", "Plane", "Axisymmetric", "Volume")),  # tests/total/test_frame.py
    *(f"{role}_{space}({basis})" for role in ("take", "give") for space in ("plane", "volume") for basis in ("Quadratic", "Cubic")),  # the same
    *(f"{way}_by_basis({basis})" for way in ("aim", "scatter_scalar", "gather_scalar") for basis in ("Linear", "Cubic")),  # the same
    "warms(NoHeating)", "carry_surface(NoExchange)", "latches(NoExpansion)", "latches(Expansion)",  # every isothermal body in two or three directions
    "latches(Latched)", "latches(Softening)",  # tests/integrate/test_latched.py, tests/point/test_laws.py
    *(f"{way}_by_law({law})" for way in ("explicit", "stabilised", "implicit") for law in ("Table", "Logistic")),  # tests/integrate/test_implicit_heat.py
    "explicit_by_law(Constant)",  # the same
    "act(Nozzle)", "unstretch(NoExchange)", "unstretch(Surface)",  # tests/integrate/test_nozzle.py
    "averages(Average)", "average(Average)", "relax(Average)",  # tests/integrate/test_fbar.py
    "grown(Line)", "grown(Plane)", "grown(Axisymmetric)", "grown(Volume)",  # the same
    *(f"{role}(Setting)" for role in ("condition", "conditions_eight", "set_one", "record_setting", "pick")), "set_one(NoSetting)",  # test_setting.py
    *(f"{role}({law})" for role in ("value", "values", "at_volume", "aspects", "pick") for law in ("Sets", "Alike", "Arrhenius")),  # the same
}  # fmt: skip


def test_every_sibling_of_every_role_was_run(plain):
    """A new law, dimension or transfer without a scene here is noticed."""
    assert set(plain["missed"]) <= ELSEWHERE


if __name__ == "__main__":
    in_plain_python()
