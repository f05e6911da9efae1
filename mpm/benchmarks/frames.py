"""What the total frame costs beside the updated one: `python -m mpm.benchmarks.frames` prints the table of docs/frames.md (a minute, once compiled).

An elastic block that turns and rings, with default settings in both frames, in turn. Processor time of its steps: of a run less that of one a tenth as long,
each the least of ROUNDS; over particles and steps, and the ratio of the two for the same length of the run.
"""

import time
from typing import Any

ROUNDS = 5
CASES = {"3-D, Hencky": (3, "hencky"), "3-D, neo-Hookean": (3, "neo_hookean"), "plane, Hencky": (2, "hencky")}
CELLS = {2: 1 / 96, 3: 1 / 16}


def block(dimension: int, law: str, frame: str, end: float) -> dict[str, Any]:
    """A cube or a square of some 36 000 particles."""
    return {
        "grid": {"dimension": dimension, "size": [2.0] * dimension, "cell": CELLS[dimension]},  # room to turn: nothing touches
        "bodies": {"block": {"shape": {"box": {"lower": [0.5] * dimension, "upper": [1.5] * dimension}},
                             "angular_velocity": [0.1, 0.2, 0.1] if dimension == 3 else 0.1, "material": "soft"}},
        "materials": {"soft": {"density": 1, "elastic": {law: {"E": 1, "nu": 0.3}}}},
        "time": {"end": end}, "output": {"every": end}, "method": {"frame": frame},
    }  # fmt: skip


def main() -> None:
    """The table."""
    from mpm.config import load
    from mpm.runner import estimate, run_point

    print("| case | frame | particles | steps | ns a particle-step | s | over updated |\n" + "|---" * 7 + "|")
    for name, (dimension, law) in CASES.items():
        end = 8.0 if dimension == 3 else 2.0
        found = {(frame, part): load(block(dimension, law, frame, part * end)) for frame in ("updated", "total") for part in (1.0, 0.1)}
        steps, least = {key: run_point(one, compare=False).steps for key, one in found.items()}, dict.fromkeys(found, float("inf"))
        for _ in range(ROUNDS):
            for key, one in found.items():
                began = time.process_time()
                run_point(one, compare=False)
                least[key] = min(least[key], time.process_time() - began)
        taken = {frame: least[frame, 1.0] - least[frame, 0.1] for frame in ("updated", "total")}
        for frame, seconds in taken.items():
            N, count = estimate(found[frame, 1.0])["particles"], steps[frame, 1.0] - steps[frame, 0.1]
            print(f"| {name} | {frame} | {N} | {count} | {1e9 * seconds / N / count:.1f} | {seconds:.3g} | {seconds / taken['updated']:.2f} |", flush=True)


if __name__ == "__main__":
    main()
