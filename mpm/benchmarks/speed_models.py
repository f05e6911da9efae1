"""Our side of the rows of mpm.benchmarks.speed that are not the thrown cube: `python -m mpm.benchmarks.speed_models WHAT`, one JSON line each.

whole [f32]   ns a particle-step of a sheared cube that flows everywhere (Hencky, radial return, heat through its faces), with physics taken away in turn
disc          seconds of the Robin disc at 3e-4 and 5e-5, from the config to the answer, geometry and assembly included
loaf          seconds of a point of configs/scenes/loaf.yaml after the first: 780 s of baking with its latent front
apart         ns a particle-step of two cubes in opposite corners of a grid of 128^3, and side by side
landing N     ms of 16 steps and of a heat step of a warm cube of 512 000 particles that lies on the floor, by N threads, and its bits
lying [f32]   ns a particle-step of a cube of 108 000 particles that lies on the floor: by contact, by contact while it slides and rubs, and by a mirror of the
              wall, which asks for no contact
slump         ns a particle-step of a point of configs/scenes/slump.yaml after the first: all of a run, its records and frames included
points        material-point steps a second of relaxation with the radial map, a thousand points in one call, all that a point costs included
Run them pinned to one core of an idle machine.
"""

import hashlib
import json
import statistics
import sys
import time
from pathlib import Path

import numpy as np

from mpm.config import load
from mpm.runner import run_point, run_points

SCENES = Path(__file__).parents[2] / "configs" / "scenes"
ROUNDS = 5
SHEAR = 2.0  # 1/s
ERRORS = (3e-4, 5e-5)
CELLS = (0.75, 0.5, 0.375, 0.3, 0.25, 0.22, 0.2, 0.19, 0.18, 0.17, 0.16, 0.15)
PACES = (*({"count": count} for count in (3, 4, 5, 6, 8, 10)), *({"tolerance": tolerance} for tolerance in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)))
BAKING = {"kappa": (0.2, 0.28, 0.35, 0.42, 0.5)}
HEAT = {"fourier": {"kappa": 0.4, "alpha": 2000}}
FLOW = {"ellipse": {"M": 20, "p0": 2, "eta": 10}}
POINTS, POINT_STEPS = 1000, 2000


def cube(flow: bool, heat: bool, dtype: str) -> dict:
    """A cube of 100 000 particles on a grid of 64^3."""
    dough = {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}} | ({"flow": FLOW} if flow else {}) | ({"heat": HEAT} if heat else {})
    body = {"shape": {"box": {"lower": [0.3, 0.3, 0.3], "upper": [0.663, 0.663, 0.663]}}, "material": "dough"} | ({"temperature": 300} if heat else {})
    faces = [{"of": "cube", "convection": {"beta": 500, "outside": 363}}] if heat else []
    return {
        "title": "Sheared cube", "grid": {"dimension": 3, "size": [1, 1, 1], "cell": 1 / 64}, "bodies": {"cube": body}, "materials": {"dough": dough},
        "surfaces": faces, "time": {"end": 1}, "method": {"precision": {"f32": "float32", "f64": "float64"}[dtype]},
    }  # fmt: skip


def sheared(flow: bool, heat: bool, dtype: str):
    """The cube in simple shear, after enough steps that all of it flows, if it may."""
    from mpm.study.phases import Bench

    found = Bench(load(cube(flow, heat, dtype)))
    particles = found.scene.bodies[0].particles
    particles.v[:, 0], particles.C[:, 0, 1] = SHEAR * (particles.x[:, 1] - particles.x[:, 1].mean()), SHEAR
    for _ in range(60):
        found.steps()
    return found


def flowing(bench) -> float:
    """Share of particles on or outside the ellipse."""
    B = bench.scene.bodies[0].particles.B.astype(float)
    mu = 1e5 / 2.6
    deviator = 0.5 * (B[:, :3] - B[:, :3].mean(1, keepdims=True))
    q = np.sqrt(6.0) * mu * np.sqrt((deviator**2).sum(1) + 0.5 * (B[:, 3:] ** 2).sum(1))
    return float((q > 0.999 * FLOW["ellipse"]["M"]).mean())


def whole(dtype: str = "f64") -> dict:
    """Medians of rounds in turn; heat steps come at their own pace, `every` so many mechanical steps."""
    made = {name: sheared(flow, heat, dtype) for name, flow, heat in (("elastic", False, False), ("heat", False, True), ("whole", True, True))}
    times: dict[str, list[float]] = {name: [] for name in made}
    for _ in range(ROUNDS):
        for name, bench in made.items():
            times[name].append(bench.step_ns())
    found = {f"{name}_ns": statistics.median(one) for name, one in times.items()}
    bench = made["whole"]
    heat_step = statistics.median(timed(bench.heat) for _ in range(ROUNDS)) * 1e9 / bench.particles
    every = bench.now.pace / (bench.now.step() * bench.scene.safety)
    return found | {"heat_step_ns": heat_step, "every": every, "flowing": flowing(bench), "particles": bench.particles, "dtype": dtype}


def timed(call) -> float:
    """Seconds of a call."""
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def disc_config(cell: float, tolerance: float = 1e-4, count: int | None = None) -> dict:
    """A disc of radius 1 at Bi = 10, as peer_fem.py has it; `count`: equal steps instead of those that the tolerance chooses."""
    return {
        "title": "Robin disc", "grid": {"dimension": 2, "size": [3, 3], "cell": cell},
        "bodies": {"disc": {"shape": {"ball": {"centre": [1.5, 1.5], "radius": 1}}, "temperature": 301, "material": "unit"}},
        "materials": {"unit": {"density": 1, "heat": {"fourier": {"kappa": 1, "alpha": 1}}}},
        "surfaces": [{"of": "disc", "convection": {"beta": 10, "outside": 300}}], "output": {"every": 0.2},
        "time": {"end": 0.2} | ({"step": 0.2 / count} if count else {}),
        "method": {"offset": [0.3, 0.2], "rigid": {"implicit": {"order": 4, "tolerance": tolerance}}}, "exact": {"robin_cylinder": {}},
    }  # fmt: skip


def disc() -> dict:
    """The cheapest of a few settings at each error: {error: [seconds, error, cell, steps]}, steps of equal size (`count`) or chosen (`tolerance`)."""
    from mpm.rigid.geometry import geometry

    found: dict[str, list] = {}
    for cell in CELLS:
        for pace in PACES:
            experiment = load(disc_config(cell, **pace))
            error = run_point(experiment).finals["error_l2"]
            seconds = []
            for _ in range(ROUNDS):
                geometry.cache_clear()
                seconds.append(timed(lambda experiment=experiment: run_point(experiment, compare=False)))
            for wanted in ERRORS:
                if error <= wanted and min(seconds) < found.get(f"{wanted:g}", [np.inf])[0]:
                    found[f"{wanted:g}"] = [min(seconds), error, cell, pace]
    return found


def loaf() -> dict:
    """Median over points that differ in kappa, one after another in a process, as a worker of a sweep has them."""
    data = load(SCENES / "loaf.yaml").resolved() | {"sweep": None}
    seconds = []
    for kappa in (*BAKING["kappa"][:1], *BAKING["kappa"]):
        data["materials"]["dough"]["heat"]["fourier"]["kappa"] = kappa
        experiment = load(data)
        seconds.append(timed(lambda experiment=experiment: run_point(experiment)))
    return {"seconds": statistics.median(seconds[1:]), "first": seconds[0]}


def slump() -> dict:
    """Median over runs of a small moving scene, as a worker of a sweep has them."""
    experiment = load(load(SCENES / "slump.yaml").resolved() | {"sweep": None, "smoke": None})
    runs = [run_point(experiment) for _ in range(1 + ROUNDS)]
    particles, steps, seconds = runs[0].facts["particles"], runs[0].steps, statistics.median(run.wall_time for run in runs[1:])
    return {"step_ns": 1e9 * seconds / particles / steps, "particles": particles, "steps": steps, "seconds": seconds}


def apart() -> dict:
    """Medians of rounds in turn, float64, 31 000 particles."""
    from mpm.study.phases import Bench

    made, size = {}, 12 / 128
    for name, lower in (("apart_ns", [0.85] * 3), ("together_ns", [0.05 + 1.5 * size, 0.05, 0.05])):
        boxes = {"one": [0.05] * 3, "other": lower}
        bodies = {key: {"shape": {"box": {"lower": a, "upper": [b + size for b in a]}}, "material": "solid"} for key, a in boxes.items()}
        made[name] = Bench(load({
            "title": "Two cubes", "grid": {"dimension": 3, "size": [1, 1, 1], "cell": 1 / 128}, "bodies": bodies, "time": {"end": 1},
            "materials": {"solid": {"density": 1000, "elastic": {"neo_hookean": {"E": 1e5, "nu": 0.3}}}}, "method": {"precision": "float64"},
        }))  # fmt: skip
    times: dict[str, list[float]] = {name: [] for name in made}
    for _ in range(ROUNDS):
        for name, bench in made.items():
            times[name].append(bench.step_ns())
    return {name: statistics.median(found) for name, found in times.items()}


def landing(threads: str) -> dict:
    """Medians; every step has contacts. `bits`: a hash of what the particles end with."""
    from mpm.study.phases import Bench

    rubber = {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}, "heat": {"fourier": {"kappa": 100, "alpha": 1}}}
    shape = {"box": {"lower": [0.35, 0.35, 0.0], "upper": [1.6, 1.6, 1.25]}}
    made = Bench(load({
        "title": "Cube on a floor", "grid": {"dimension": 3, "size": [2, 2, 2], "cell": 1 / 32}, "walls": {"bottom": "contact"}, "gravity": [0, 0, -9.81],
        "bodies": {"cube": {"shape": shape, "material": "rubber", "velocity": [0, 0, -0.5], "temperature": 400}}, "materials": {"rubber": rubber},
        "surfaces": [{"of": "cube", "convection": {"beta": 10, "outside": 300}}], "time": {"end": 1},
    }), int(threads))  # fmt: skip
    made.block = 16
    made.steps()
    made.heat()
    steps, heat = ([timed(call) for _ in range(ROUNDS)] for call in (made.steps, made.heat))
    body = made.scene.bodies[0]
    bits = hashlib.sha256(b"".join(array.tobytes() for array in (*body.particles, body.thermal.theta))).hexdigest()
    found = {"steps_ms": 1e3 * statistics.median(steps), "heat_ms": 1e3 * statistics.median(heat)}
    return found | {"touching": bool(made.clock.touching), "particles": made.particles, "bits": bits}


def on_floor(dtype: str) -> dict:
    """The cube by contact, sliding, and by a mirror: a Bench each."""
    from mpm.study.phases import Bench

    made = {}
    for name, wall, speed in (("contact_ns", "contact", 0.0), ("sliding_ns", {"contact": {"friction": 0.3}}, 0.5), ("mirror_ns", "slip", 0.0)):
        made[name] = Bench(load({
            "title": "Cube on a floor", "grid": {"dimension": 3, "size": [1, 1, 1], "cell": 1 / 32}, "walls": {"bottom": wall}, "gravity": [0, 0, -9.81],
            "bodies": {"cube": {"shape": {"box": {"lower": [0.14, 0.14, 0.0], "upper": [0.86, 0.86, 0.72]}}, "material": "rubber", "velocity": [speed, 0, 0]}},
            "materials": {"rubber": {"density": 1000, "elastic": {"hencky": {"E": 1e5, "nu": 0.3}}}}, "time": {"end": 1},
            "method": {"precision": {"f32": "float32", "f64": "float64"}[dtype]},
        }))  # fmt: skip
    return made


def lying(dtype: str = "f64") -> dict:
    """Medians of rounds in turn; every step has contacts, or none."""
    made = on_floor(dtype)
    times: dict[str, list[float]] = {name: [] for name in made}
    for _ in range(ROUNDS):
        for name, bench in made.items():
            times[name].append(bench.step_ns())
    found = {name: statistics.median(one) for name, one in times.items()}
    return found | {"touching": bool(made["contact_ns"].clock.touching), "particles": made["contact_ns"].particles}


def points() -> dict:
    """A batch of relaxations that flow at every step."""
    data = {
        "title": "Relaxation", "grid": {"dimension": 0}, "loading": [{}], "time": {"end": 2, "step": 2 / POINT_STEPS}, "output": {"every": 2},
        "bodies": {"body": {"shape": {"point": {"strain": {"xx": -2.33e-3, "yy": -1.33e-3, "zz": -1.33e-3}}}, "material": "solid"}},
        "materials": {"solid": {"density": 1000, "elastic": {"hencky": {"lam": 2.2e5, "mu": 1.7e5}}, "flow": {"ellipse": {"M": 1000, "p0": 0.8, "eta": 3e5}}}},
    }  # fmt: skip
    base = load(data)
    run_points([base] * POINTS)
    seconds = min(timed(lambda: run_points([base] * POINTS)) for _ in range(ROUNDS))
    return {"steps_a_second": POINTS * POINT_STEPS / seconds}


if __name__ == "__main__":
    what, *more = sys.argv[1:]
    models = {"whole": whole, "disc": disc, "loaf": loaf, "apart": apart, "landing": landing, "lying": lying, "points": points, "slump": slump}
    print(json.dumps(models[what](*more)))
