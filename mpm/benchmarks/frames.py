"""What the total frame costs beside the updated one: `python -m mpm.benchmarks.frames` prints the table of docs/frames.md (a minute, once compiled).

An elastic block that turns and rings, with default settings in both frames, in turn: processor time of a run of the same length, set-up and records included,
the least of ROUNDS, over particles and steps; and the ratio of the two times.
"""

import time
from typing import Any

ROUNDS = 5
CASES = {"3-D, Hencky": (3, "hencky"), "3-D, neo-Hookean": (3, "neo_hookean"), "plane, Hencky": (2, "hencky")}
CELLS = {2: 1 / 96, 3: 1 / 16}


def block(dimension: int, law: str, frame: str) -> dict[str, Any]:
    """A cube or a square of 32 768 or 36 864 particles, on grid lines."""
    turning, end = ([0.1, 0.2, 0.1], 3.0) if dimension == 3 else (0.1, 1.5)
    return {
        "grid": {"dimension": dimension, "size": [1.5] * dimension, "cell": CELLS[dimension]},
        "bodies": {"block": {"shape": {"box": {"lower": [0.25] * dimension, "upper": [1.25] * dimension}}, "angular_velocity": turning, "material": "soft"}},
        "materials": {"soft": {"density": 1, "elastic": {law: {"E": 1, "nu": 0.3}}}},
        "time": {"end": end}, "output": {"every": end}, "method": {"frame": frame},
    }  # fmt: skip


def main() -> None:
    """The table."""
    from mpm.config import load
    from mpm.runner import estimate, run_point

    print("| case | frame | particles | steps | ns a particle-step | s | over updated |\n" + "|---" * 7 + "|")
    for name, (dimension, law) in CASES.items():
        found = {frame: load(block(dimension, law, frame)) for frame in ("updated", "total")}
        least, steps = dict.fromkeys(found, float("inf")), {frame: run_point(one, compare=False).steps for frame, one in found.items()}
        for _ in range(ROUNDS):
            for frame, one in found.items():
                began = time.process_time()
                run_point(one, compare=False)
                least[frame] = min(least[frame], time.process_time() - began)
        for frame, one in found.items():
            N = estimate(one)["particles"]
            row = f"{N} | {steps[frame]} | {1e9 * least[frame] / N / steps[frame]:.1f} | {least[frame]:.3g} | {least[frame] / least['updated']:.2f}"
            print(f"| {name} | {frame} | {row} |", flush=True)


if __name__ == "__main__":
    main()
