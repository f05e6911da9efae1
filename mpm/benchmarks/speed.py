"""The table of speed: `python -m mpm.benchmarks.speed --peers FOLDER --python PYTHON`, beside the programs of other MPM codes on the same scene.

FOLDER holds peer_taichi.py and peer_warp.py (same options and JSON line as `mpm bench`), PYTHON is an interpreter that has them. Whole processes, pinned to
one core, in turn (ours, Taichi tuned, Warp), ROUNDS times; ratios of medians of the median step; `check` must agree. Without --peers: our own rows only.
Prints a table in Markdown with machine and versions; every figure is of this run.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

from mpm.records.provenance import machine, versions

ROOT = Path(__file__).parents[2]
CASES = (  # what, options of the scene, floors: times Taichi tuned, times Warp
    ("3-D elastic, 64³, float32", "--n 64 --np 100000 --dtype f32", 2.5, 3.3),
    ("3-D elastic, 64³, float64", "--n 64 --np 100000 --dtype f64", 2.0, 2.5),
    ("3-D elastic, 128³, float32", "--n 128 --np 512000 --dtype f32 --reps 5", 2.5, 3.3),
    ("3-D elastic, 128³, float64", "--n 128 --np 512000 --dtype f64 --reps 5", 2.0, 2.5),
    ("2-D elastic, 256², float32", "--dim 2 --n 256 --np 100000 --dtype f32", 1.6, None),
    ("2-D elastic, 256², float64", "--dim 2 --n 256 --np 100000 --dtype f64", 1.2, None),
    ("2-D elastic, 4 000 particles, float32", "--dim 2 --n 64 --np 4000 --dtype f32 --steps 200", 2.0, None),
    ("3-D elastic, 4 000 particles, float32", "--n 32 --np 4000 --dtype f32 --steps 100", 2.0, None),
)
DIGITS = {"f32": 3e-5, "f64": 3e-7}
INDEPENDENT = "--n 64 --np 100000 --dtype f64 --reps 30"


def pinned(core: int | str, command: list[str]) -> list[str]:
    """The command on one core, or on "0,1"."""
    return ["taskset", "-c", str(core), *command]


def ours(options: str) -> list[str]:
    return [sys.executable, "-c", "import sys; from mpm_cli.main import main; sys.exit(main(sys.argv[1:]))", "bench", *options.split()]


def line(command: list[str], core: int | str = 0) -> dict:
    """The JSON line of a program."""
    environment = os.environ | {name: "1" for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    done = subprocess.run(pinned(core, command), capture_output=True, text=True, check=False, env=environment)
    found = [text for text in done.stdout.splitlines() if text.startswith("{")]
    if not found:
        raise RuntimeError(f"{' '.join(command)}: no JSON line\n{done.stderr[-2000:]}")
    return json.loads(found[-1])


def agree(a: list[float], b: list[float], dtype: str) -> bool:
    """Whether two checks are those of the same work."""
    return all(math.isclose(x, y, rel_tol=DIGITS[dtype], abs_tol=DIGITS[dtype]) for x, y in zip(a, b, strict=True))


def rows(peers: Path | None, python: str | None, rounds: int, only: str):
    """One line of the table a case: ours in ns a particle-step, ratios, floors."""
    for name, options, taichi_floor, warp_floor in (case for case in CASES if only in case[0]):
        programs = {"mpm": ours(options)}
        if peers is not None:
            programs["taichi"] = [python, str(peers / "peer_taichi.py"), "--variant", "tuned", *options.split()]
            if warp_floor is not None:  # its program knows three dimensions only
                programs["warp"] = [python, str(peers / "peer_warp.py"), *options.split()]
        line(programs["mpm"])  # compiles
        lines = {key: [] for key in programs}
        for _ in range(rounds):
            for key, command in programs.items():
                lines[key].append(line(command))
        median = {key: statistics.median(one["med_ms"] / one["N"] for one in found) for key, found in lines.items()}
        checked = all(agree(lines["mpm"][0]["check"], found[0]["check"], found[0]["dtype"]) for found in lines.values())
        ratios = [f"{median[key] / median['mpm']:.2f} x" if key in median else "" for key in ("taichi", "warp")]
        floors = " / ".join(f"{floor} x" for floor in (taichi_floor, warp_floor) if floor)
        size = lines["mpm"][0]["bytes_particle"]
        yield f"| {name} | {1e6 * median['mpm']:.1f} | {ratios[0]} | {ratios[1]} | {floors} | {size} | {'agree' if checked else 'DIFFER'} |"


def shuffled() -> str:
    """Particles in random order against a lattice, over a run of 100 steps: the time of every step and sort in it, without what is compiled."""
    times: dict[str, list[float]] = {"lattice": [], "shuffle": []}
    for _ in range(3):
        for order, found in times.items():
            found.append(line(ours(f"--dtype f32 --order {order} --warm 1 --reps 10"))["total_ms"])
    ratio = statistics.median(times["shuffle"]) / statistics.median(times["lattice"])
    return f"particles in random order, sorting counted, 100 steps: {ratio:.2f} of the time on a lattice"


def threads() -> str:
    """Two threads on one run of 512 000 particles against one, which does the same in the same order."""
    said = []
    for dtype, name in (("f32", "float32"), ("f64", "float64")):
        found: dict[int, list[dict]] = {1: [], 2: []}
        for _ in range(3):
            for count, lines in found.items():
                lines.append(line(ours(f"--n 128 --np 512000 --dtype {dtype} --steps 16 --reps 3 --threads {count}"), "0,1"))
        one, two = (statistics.median(each["med_ms"] for each in lines) for lines in found.values())
        same = all(each["check"] == found[1][0]["check"] for each in found[2])
        said.append(f"{one / two:.2f} x one ({name}, check {'the same' if same else 'DIFFERENT'})")
    return "two threads on 512 000 particles: " + ", ".join(said)


def two_runs() -> str:
    """Two independent runs on two cores against one."""
    alone = line(ours(INDEPENDENT))["Mpps_med"]
    environment = os.environ | {"NUMBA_NUM_THREADS": "1"}
    both = [subprocess.Popen(pinned(core, ours(INDEPENDENT)), stdout=subprocess.PIPE, text=True, env=environment) for core in (0, 1)]
    together = sum(json.loads(process.communicate()[0].splitlines()[-1])["Mpps_med"] for process in both)
    return f"two independent runs on two cores: {together / alone:.2f} x one"


def start_up() -> str:
    """First cached step after import, and `mpm --help`."""
    first = min(line(ours("--dtype f32 --n 32 --np 4000"))["first_s"] for _ in range(3))
    times = []
    for _ in range(5):
        began = time.perf_counter()
        subprocess.run([*ours("")[:3], "--help"], capture_output=True, check=True)
        times.append(time.perf_counter() - began)
    return f"first cached step after import: {first:.2f} s; `mpm --help`: {min(times):.2f} s"


def grown() -> str:
    """ns a particle-step from ten thousand to a million particles."""
    found = [line(ours(f"--dtype f64 --n {n} --np {count} --reps 3")) for n, count in ((32, 10_000), (64, 100_000), (160, 1_000_000))]
    return "ns a particle-step, float64, at 1e4, 1e5, 1e6 particles: " + ", ".join(f"{1e6 * one['med_ms'] / one['N']:.1f}" for one in found)


def model(*what: str, core: int | str = 0) -> dict:
    """A line of mpm.benchmarks.speed_models, on one core, or on those of the list."""
    return line([sys.executable, "-m", "mpm.benchmarks.speed_models", *what], core)


def landing() -> str:
    """Two threads on a scene with contact and heat against one."""
    found: dict[str, list[dict]] = {"1": [], "2": []}
    for _ in range(3):
        for count, rows in found.items():
            rows.append(model("landing", count, core="0,1"))
    one, two = ({name: statistics.median(row[name] for row in rows) for name in ("steps_ms", "heat_ms")} for rows in found.values())
    gains = {name: one[name] / two[name] for name in one} | {"both": sum(one.values()) / sum(two.values())}
    same = "the same" if len({row["bits"] for rows in found.values() for row in rows}) == 1 else "DIFFERENT"
    return (
        f"two threads on {found['1'][0]['particles']} particles on a floor, float64: 16 steps with contacts {gains['steps_ms']:.2f} x one, a heat step "
        f"{gains['heat_ms']:.2f} x one, together {gains['both']:.2f} x one (bits {same}; by one {one['steps_ms']:.0f} and {one['heat_ms']:.0f} ms)"
    )


def lying() -> str:
    """What contact adds to the step of a cube on a floor."""
    said = []
    for dtype, name in (("f64", "float64"), ("f32", "float32")):
        one = model("lying", dtype)
        more = 100 * (one["contact_ns"] / one["mirror_ns"] - 1)
        said.append(f"{name}: {one['contact_ns']:.0f} ns a particle-step, by a mirror {one['mirror_ns']:.0f} (+{more:.0f} %)")
    return f"a cube of {one['particles']} particles that lies on a floor by contact: " + "; ".join(said)


def whole_step() -> str:
    """What heat and flow add to a step in three dimensions, and the whole of it."""
    said = []
    for dtype, name in (("f64", "float64"), ("f32", "float32")):
        one = model("whole", dtype)
        heat = 100 * (one["heat_ns"] / one["elastic_ns"] - 1)
        said.append(
            f"{name}: elastic {one['elastic_ns']:.0f} ns, heat on {one['heat_ns']:.0f} ns (+{heat:.0f} %), "
            f"with flow at {100 * one['flowing']:.0f} % of the particles {one['whole_ns']:.0f} ns; "
            f"a heat step, every {one['every']:.2g} such steps here, {one['heat_step_ns']:.0f} ns"
        )
    return "3-D thermo-viscoplastic step (Hencky, radial return, heat), a particle: " + "; ".join(said)


def small_scene() -> str:
    """A whole run of a few particles and many steps."""
    found = model("slump")
    size = f"{found['particles']} particles and {found['steps']} steps"
    return f"slump, a whole run of {size}: {found['step_ns']:.0f} ns a particle-step ({found['seconds']:.2f} s)"


def empty_boxes() -> str:
    """What the empty box around two bodies costs."""
    found = model("apart")
    return f"two cubes of 12 cells in opposite corners of 128³, float64: {found['apart_ns']:.0f} ns a particle-step, side by side {found['together_ns']:.0f}"


def smaller_models() -> str:
    """Heat of bodies that do not move, and material points."""
    baked, points = model("loaf"), model("points")
    rate = f"0-D: {points['steps_a_second']:.2g} steps a second with the radial map"
    return f"the loaf, heat only, 780 s, a point of a warm sweep: {baked['seconds']:.3f} s; {rate}"


def fitted(peers: Path | None, python: str | None) -> str:
    """The Robin disc at equal error beside fitted finite elements, set-up included: the cheapest setting of each."""
    found = {}
    if peers is not None:
        for steps in (4, 6, 8):
            command = [python, str(peers / "peer_fem.py"), "--order", "2", "--refine", "1", "2", "3", "4", "--steps", str(steps)]
            done = subprocess.run(pinned(0, command), capture_output=True, text=True, check=True, env=os.environ | {"OPENBLAS_NUM_THREADS": "1"})
            for text in done.stdout.splitlines():
                one = json.loads(text)
                for wanted in (3e-4, 5e-5):
                    if one["rms"] <= wanted:
                        found[wanted] = min(found.get(wanted, math.inf), one["seconds"])
    said = []
    for wanted, (seconds, error, cell, pace) in sorted(((float(key), value) for key, value in model("disc").items()), reverse=True):
        steps = f"{pace['count']} equal steps" if "count" in pace else f"tolerance {pace['tolerance']:g}"
        beside = f", scikit-fem P2 {1e3 * found[wanted]:.1f} ms: {found[wanted] / seconds:.1f} x" if wanted in found else ""
        said.append(f"{wanted:g} in {1e3 * seconds:.1f} ms (error {error:.1e}, cell {cell:g}, {steps}){beside}")
    return "Robin disc, from config to answer: " + "; ".join(said)


FIGURES = {
    "random order": shuffled, "threads": threads, "independent runs": two_runs, "start": start_up, "growth": grown, "whole step": whole_step,
    "empty box": empty_boxes, "landing": landing, "lying": lying, "slump": small_scene,
    "smaller models": smaller_models,
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description="Speed beside other codes, as a table in Markdown.")
    parser.add_argument("--peers", type=Path)
    parser.add_argument("--python")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", default="", help="rows whose name holds this; figures too: " + ", ".join([*FIGURES, "disc"]))
    given = parser.parse_args()
    about = machine()
    print(
        f"{about.get('processor', about)}, load {os.getloadavg()[0]:.1f} at the start; "
        + ", ".join(f"{k} {v}" for k, v in versions().items() if k in ("mpm", "numba", "numpy"))
    )
    print(
        "\n| scene, one core | ns a particle-step | Taichi tuned / ours | Warp / ours | floor | B of state a particle | check |\n|---|---|---|---|---|---|---|"
    )
    for row in rows(given.peers, given.python, given.rounds, given.only):
        print(row, flush=True)
    print()
    for name, figure in FIGURES.items():
        if given.only in name:
            print(f"- {figure()}", flush=True)
    if given.only in "disc":
        print(f"- {fitted(given.peers, given.python)}", flush=True)


if __name__ == "__main__":
    main()
