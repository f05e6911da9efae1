"""Scenes in which bodies meet, run in plain Python: a child process without the compiler takes seconds where compiling takes a minute."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

PLAIN = """
import json, sys
from mpm.config import load
from mpm.runner import run_point
for line in sys.stdin:
    run = run_point(load(json.loads(line)), compare=False)
    series = {name: values.tolist() for name, values in run.series.items()}
    found = {"kind": run.outcome.kind, "message": run.outcome.message, "times": run.times.tolist(), "series": series, "facts": run.facts}
    print(json.dumps(found, default=str))
"""


def played(configs: list[dict]) -> list[dict]:
    """Runs of many configs: outcome `kind`, `times`, `series` as arrays, `facts`."""
    done = subprocess.run([sys.executable, "-c", PLAIN], input="\n".join(map(json.dumps, configs)), capture_output=True, text=True, check=False,
                          env=os.environ | {"NUMBA_DISABLE_JIT": "1"})  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    runs = [json.loads(line) for line in done.stdout.splitlines()]
    for run in runs:
        run["series"] = {name: np.array(values, dtype=float) for name, values in run["series"].items()}
        run["times"] = np.array(run["times"])
    return runs


@pytest.fixture(scope="session")
def plain():
    return played
