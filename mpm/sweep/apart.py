"""A short-lived interpreter beside this one, for what would make a sweep's own process large: drawing a sample (scipy.stats) or a picture (matplotlib)."""

import json
import os
import subprocess
import sys
from typing import Any

from mpm.sweep.processes import ONE_THREAD

# with the parent's module path, so that it imports the same files whatever the current folder holds
START = "import json, sys; sys.path[:] = json.loads(sys.argv.pop(1)); "


def apart(code: str, *words: str, **how: Any) -> subprocess.CompletedProcess:
    """Run `code`, with `words` as sys.argv[1:]. `how` as in subprocess.run; standard output and error are this process's own unless it says otherwise."""
    command = [sys.executable, "-P", "-c", START + code, json.dumps(sys.path), *words]
    return subprocess.run(command, stdin=subprocess.DEVNULL, env={**os.environ, **ONE_THREAD}, check=False, **how)
