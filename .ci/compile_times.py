"""What compiling costs here and in another checkout, in turn: `.venv/bin/python .ci/compile_times.py OTHER [ROUNDS] [ROW...]`, on an idle machine.

Every row runs in a copy of each checkout, by this Python, its compile cache empty; medians over the rounds. Rows:

scenes  processor seconds, wall seconds and the largest memory of `mpm run SCENE --smoke`      main   wall seconds of `mpm sweep configs/scenes/loaf.yaml`
edit    the cube again after an edit of guards.py                                             ball   set-up of a ball of 932 000 particles in 3-D
text    instructions that LLVM is given for the cube, in thousands; of these: tuples and arrays taken apart and together; counts of users of arrays
warm    `mpm bench --np 100000`: milliseconds a step, 3-D f64 and 2-D f32, and seconds of a slump, compiled before
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
MPM = "import sys; from mpm_cli.main import main; sys.exit(main(sys.argv[1:]))"
BALL = """
import mpm
from mpm.scene.build import build
scene = build(mpm.load({
    "grid": {"dimension": 3, "size": [1.0, 1.0, 1.0], "cell": 0.015625},
    "bodies": {"ball": {"shape": {"ball": {"centre": [0.5, 0.5, 0.5], "radius": 0.4734}}, "material": "m"}},
    "materials": {"m": {"density": 1000.0, "elastic": {"hencky": {"E": 1e4, "nu": 0.3}}}}, "time": {"end": 0.01}, "output": {"every": 0.01},
}))
assert 9e5 < len(scene.bodies[0].particles.m) < 1e6
"""
SLUMP = """
import mpm
experiment = mpm.load({
    "grid": {"dimension": 2, "size": [0.024, 0.012], "cell": 0.001},
    "bodies": {"block": {"shape": {"box": {"lower": [0.008, 0], "upper": [0.016, 0.008]}}, "temperature": 303.15, "material": "dough"}},
    "materials": {"dough": {
        "density": 1000, "elastic": {"hencky": {"E": 4e3, "nu": 0.3}},
        "flow": {"ellipse": {"M": {"logistic": {"low": 60, "high": 6, "at": 313.15, "width": 3}}, "p0": 5, "eta": 5}},
        "heat": {"fourier": {"kappa": 0.4, "alpha": 2000}},
    }},
    "surfaces": [{"of": "block", "side": "bottom", "convection": {"beta": 500, "outside": 363.15}}],
    "walls": {"bottom": "stick"}, "gravity": [0, -9.81], "time": {"end": 0.6}, "output": {"every": 0.1},
})
print(min(mpm.run_point(experiment).wall_time for _ in range(4)))
"""
TEXT = """
import json, sys, tempfile
from llvmlite import binding
from mpm_cli.main import main
found, parse = [0, 0, 0], binding.parse_assembly
def counted(text, *rest):
    lines = [line for line in text.splitlines() if line.startswith("  ")]
    found[0] += len(lines)
    found[1] += sum(" extractvalue " in line or " insertvalue " in line for line in lines)
    found[2] += sum("NRT_incref" in line or "NRT_decref" in line for line in lines)
    return parse(text, *rest)
binding.parse_assembly = counted
try:
    main(["run", "configs/scenes/cube.yaml", "--smoke", "-q", "-o", tempfile.mkdtemp() + "/out"])
finally:
    print(json.dumps(found))
"""
SCENES = ("slab", "loaf", "cube", "chocolate_pour", "slump", "loaf_oven_spring")


def copy(checkout: Path, into: Path) -> Path:
    """The sources of a checkout, importable from there."""
    for name, called in (("mpm", "mpm"), ("cli", "mpm_cli"), ("configs", "configs")):
        shutil.copytree(checkout / name, into / called, ignore=shutil.ignore_patterns("__pycache__"))
    return into


def timed(place: Path, cache: Path, *command: str) -> tuple[dict[str, float], str]:
    """Processor and wall seconds and megabytes of a command in a copy, and what it wrote."""
    env = os.environ | {"PYTHONPATH": str(place), "XDG_CACHE_HOME": str(cache)}
    env.pop("MPM_CACHE_DIR", None)
    began = time.perf_counter()
    with tempfile.TemporaryFile("w+") as wrote:
        child = subprocess.Popen([sys.executable, "-c", *command], cwd=place, env=env, stdout=wrote, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        wrote.seek(0)
        said = wrote.read()
    assert child.returncode == 0, said[-3000:]
    return {"cpu": used.ru_utime + used.ru_stime, "wall": time.perf_counter() - began, "MB": used.ru_maxrss / 1000}, said


def scene(place: Path, cache: Path, name: str) -> dict[str, float]:
    return timed(place, cache, MPM, "run", f"configs/scenes/{name}.yaml", "--smoke", "-q", "-o", tempfile.mkdtemp(dir=cache))[0]


def edit(place: Path, cache: Path) -> dict[str, float]:
    scene(place, cache, "cube")
    with open(place / "mpm" / "guards.py", "a") as file:
        file.write("# edited\n")
    return scene(place, cache, "cube")


def text(place: Path, cache: Path) -> dict[str, float]:
    found = json.loads(timed(place, cache, TEXT)[1].strip().splitlines()[-1])
    return {name: count / 1000 for name, count in zip(("all", "apart and together", "counts of users"), found, strict=True)}


def warm(place: Path, cache: Path) -> dict[str, float]:
    found = {}
    for dim, dtype, n in (("3", "f64", "64"), ("2", "f32", "256")):
        for _ in range(2):  # the first compiles
            said = timed(place, cache, MPM, "bench", "--n", n, "--np", "100000", "--dim", dim, "--dtype", dtype)[1]
        found[f"{dim}-D {dtype} ms"] = json.loads(said.strip().splitlines()[-1])["med_ms"]
    return found | {"slump s": float(timed(place, cache, SLUMP)[1].strip().splitlines()[-1])}


ROWS = {name: lambda place, cache, name=name: scene(place, cache, name) for name in SCENES} | {
    "main": lambda place, cache: timed(place, cache, MPM, "sweep", "configs/scenes/loaf.yaml", "-q", "-o", tempfile.mkdtemp(dir=cache))[0],
    "edit": edit,
    "ball": lambda place, cache: timed(place, cache, BALL)[0],
    "text": text,
    "warm": warm,
}


def main(other: str, rounds: str = "3", *rows: str) -> None:
    for row in rows or ROWS:
        found: dict[str, list[dict[str, float]]] = {"here": [], "other": []}
        for _ in range(int(rounds)):
            for name, checkout in (("here", HERE), ("other", Path(other))):
                with tempfile.TemporaryDirectory() as folder:
                    (cache := Path(folder, "cache")).mkdir()
                    found[name].append(ROWS[row](copy(checkout, Path(folder, "copy")), cache))
        for name, each in found.items():
            print(f"{row:18}{name:7}" + "  ".join(f"{key} {statistics.median(one[key] for one in each):.4g}" for key in each[0]), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
