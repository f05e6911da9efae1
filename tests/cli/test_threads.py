"""A command uses no more threads than it says: BLAS takes one."""

import os
import subprocess
import sys

import pytest

COUNT = """
import mpm_cli.main, os, sys
assert "numpy" not in sys.modules
import numpy as np
from scipy.linalg import cholesky
a = np.random.default_rng(0).normal(size=(600, 600))
cholesky(a @ a.T)
print(len(os.listdir("/proc/self/task")))
"""


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="threads are counted in /proc")
def test_blas_takes_one_thread():
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    done = subprocess.run([sys.executable, "-c", COUNT], env=environment, capture_output=True, text=True, check=True)
    assert int(done.stdout) == 1
