"""How many points to hand out at once. Tiny points go in batches, so that one message and one sync on the disk serve many.

A batch is sized to last BATCH seconds at the pace seen so far. It grows by GROW at most from one to the next, since points differ, and is cut
so that the last batches end together. A batch that dies or overruns is handed out again point by point, so that only the point at fault pays.
The material points of a batch are one compiled call (mpm.runner.run_points), those of a worker are not: a kill would cost them all, and there is nothing to
gain. 12 800 points of configs/scenes/dough_rheometer.yaml take 10.1 s of processor in one call and 10.3 s in 100 calls of 128.
"""

import math

BATCH = 0.25  # s; also about what a kill can cost
GROW = 4
MOST_POINTS = 128  # points


class BatchSize:
    """Seconds a point, overhead included, averaged over the last batches."""

    def __init__(self) -> None:
        self.seconds = math.inf
        self.last = 1

    def heard(self, seconds: float, points: int) -> None:
        """A task of so many points took so long."""
        each = seconds / points
        self.seconds = each if math.isinf(self.seconds) else 0.5 * self.seconds + 0.5 * each
        self.last = points

    def batch(self, left: int, workers: int) -> int:
        """Points for the next task, of those that are left."""
        size = min(int(BATCH / self.seconds), GROW * self.last, MOST_POINTS, math.ceil(left / (2 * max(1, workers))))
        return max(1, size)
