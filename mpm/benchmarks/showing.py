"""What showing results costs, by the commands that a user types: `python -m mpm.benchmarks.showing [OUT]` prints it (a temporary folder unless OUT is given).

movie     48 frames of 20 000 particles, 600 x 400 pixels        asked: 15 s
report    a sweep of 1 000 points                                 asked: 10 s, 3 MB
export    50 frames of 20 000 particles to VTKHDF                 asked: 2 s
help      `mpm --help`, the least of five                         asked: 0.15 s
sweep     the largest memory of `mpm sweep` of those 1 000 points, and of 8  asked: 70 MB; of its own process, from Linux (VmHWM), picture and all. Workers
          and the short-lived processes that draw the sample, make the dataset and draw the picture are others

Seconds are of the processor, import of Python and mpm included; in brackets those that went by.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CALL = "import sys; sys.argv[0] = 'mpm'; from mpm_cli.main import main; sys.exit(main())"
PEAK = "import atexit; atexit.register(lambda: print(next(row.split()[1] for row in open('/proc/self/status') if row.startswith('VmHWM')))); "
BLOCK = """
title: A soft block that flies, 20 000 particles
grid: {dimension: 2, size: [1, 1], cell: 5 mm}
bodies:
  block: {shape: {box: {lower: [0.1, 0.3], upper: [0.6, 0.55]}}, material: gel, velocity: [0.2, 0.1], angular_velocity: 0.5, temperature: 30 degC}
materials:
  gel: {density: 1000, elastic: {hencky: {E: 1e3, nu: 0.3}}}
time: {end: 0.49}
output: {every: 0.01, snapshots: {every: 0.01, particles: [position, velocity, pressure, J]}}
"""
POINTS = """
title: A cube of meat that cools, a thousand ways
grid: {dimension: 0}
bodies:
  cube: {shape: {point: {surface_to_volume: 60}}, temperature: 80 degC, material: meat}
materials:
  meat: {density: 1050, heat: {fourier: {alpha: 3500, kappa: 0.45}}}
surfaces:
  - {of: cube, convection: {beta: 20, outside: 20 degC}}
time: {end: 30 min}
output: {every: 1 min, observables: [temperature.mean]}
sweep: {sample: {sobol: {count: 1000, seed: 1, ranges: {beta: {log: [5, 500]}, alpha: [3000, 4000]}}}}
"""


def took(code: str, *words: str) -> tuple[float, float, str]:
    """(processor seconds with those of children, seconds that went by, what was printed) of a Python process; RuntimeError where it failed."""
    began, before = time.perf_counter(), os.times()
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=False)
    wall, after = time.perf_counter() - began, os.times()
    if done.returncode:
        raise RuntimeError(f"mpm {' '.join(words)} ended with {done.returncode}: {(done.stderr or done.stdout)[-600:]}")
    return after.children_user + after.children_system - before.children_user - before.children_system, wall, done.stdout


def measured(out: Path) -> list[tuple[str, str, str]]:
    """(what, measured, asked)."""
    block, points = out / "block.yaml", out / "points.yaml"
    block.write_text(BLOCK)
    points.write_text(POINTS)
    for end, name in ((0.49, "fifty"), (0.47, "forty_eight")):
        took(CALL, "run", str(block), "--set", f"time.end={end}", "-o", str(out / name), "-q")
    peaks = {}
    for count, name in ((1000, "points"), (8, "few")):
        _, _, said = took(PEAK + CALL, "sweep", str(points), "--set", f"sweep.sample.sobol.count={count}", "-o", str(out / name), "-q")
        peaks[count] = int(said.split()[-1]) * 1024 / 1e6
    rows = []
    for what, asked, words in (
        ("movie of 48 frames of 20 000 particles, 600 x 400", "15 s", ("movie", str(out / "forty_eight"), "--size", "600x400", "-q")),
        ("report of 1 000 points", "10 s", ("report", str(out / "points"), "-q")),
        ("export of 50 frames of 20 000 particles", "2 s", ("export", str(out / "fifty"), "--to", str(out / "fifty.vtkhdf"), "-q")),
    ):
        processor, wall, _ = took(CALL, *words)
        rows.append((what, f"{processor:.2f} s ({wall:.2f} s)", asked))
    helps = sorted(took(CALL, "--help")[:2] for _ in range(5))
    size = (out / "points/report.html").stat().st_size / 1e6
    rows += [("size of that report", f"{size:.2f} MB", "3 MB"), ("mpm --help", f"{helps[0][0]:.3f} s ({min(wall for _, wall in helps):.3f} s)", "0.15 s")]
    return rows + [(f"largest memory of a sweep's parent, {count} points", f"{peak:.1f} MB", "70 MB") for count, peak in peaks.items()]


def main() -> None:
    with tempfile.TemporaryDirectory() as temporary:
        out = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        out.mkdir(parents=True, exist_ok=True)
        rows = measured(out)
    width = max(len(what) for what, _, _ in rows)
    for what, found, asked in rows:
        print(f"{what:<{width}}  {found:<18}  asked: under {asked}")


if __name__ == "__main__":
    main()
