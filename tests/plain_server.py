"""Runs tests without the compiler, for tests/conftest.py: `NUMBA_DISABLE_JIT=1 python tests/plain_server.py`.

Reads a line of JSON for each module that has plain tests: {"arguments": of pytest, "reports": file for them, "output": file for what is printed};
answers a line when they have run. Each module runs in a fork of this process, which has imported all that they need: to import takes longer than most tests.
"""

import json
import os
import sys

import pytest

import mpm.runner
import mpm.scene.build
import mpm.simulation  # noqa: F401


def run(arguments: list[str], reports: str, output: str) -> None:
    os.environ["MPM_TEST_REPORTS"] = reports
    printed = os.open(output, os.O_WRONLY | os.O_CREAT)
    for stream in (1, 2):
        os.dup2(printed, stream)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    code = pytest.main(arguments)
    sys.stdout.flush()
    os._exit(code)


for line in sys.stdin:
    if (child := os.fork()) == 0:
        run(**json.loads(line))
    os.waitpid(child, 0)
    print("done", flush=True)
