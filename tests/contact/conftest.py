"""Scenes in which bodies meet, run in plain Python: a child process without the compiler takes seconds where compiling takes a minute."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))  # for contact_scenes.py

PLAIN = """
import json, sys
from mpm.config import load
from mpm.runner import run_point
for line in sys.stdin:
    run = run_point(load(json.loads(line)), compare=False)
    series = {name: values.tolist() for name, values in run.series.items()}
    found = {"kind": run.outcome.kind, "message": run.outcome.message, "times": run.times.tolist(), "series": series, "facts": run.facts}
    print(json.dumps(found, default=str), flush=True)
"""


@pytest.fixture(scope="session")
def plain():
    """Runs of many configs: outcome `kind`, `times`, `series` as arrays, `facts`. One child for all tests: to start it takes longer than most runs."""
    with tempfile.TemporaryFile("w+") as said:
        child = subprocess.Popen([sys.executable, "-c", PLAIN], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=said, text=True,
                                 env=os.environ | {"NUMBA_DISABLE_JIT": "1"})  # fmt: skip

        def played(configs: list[dict]) -> list[dict]:
            runs = []
            for config in configs:
                child.stdin.write(json.dumps(config) + "\n")
                child.stdin.flush()
                line = child.stdout.readline()
                assert line, (said.seek(0), said.read()[-3000:])
                run = json.loads(line)
                run["series"] = {name: np.array(values, dtype=float) for name, values in run["series"].items()}
                run["times"] = np.array(run["times"])
                runs.append(run)
            return runs

        yield played
        child.stdin.close()
        assert child.wait() == 0
