"""The interpreter that collects a folder beside a sweep (mpm.sweep.background_collect): says in a line of JSON what came of it, and ends with its parent."""

import json
import os
import signal
import sys
import threading
from pathlib import Path

from mpm.sweep.api import collect_folder
from mpm.sweep.background_collect import told


def main() -> None:
    """Started by `Beside` with the folder and the module path as arguments."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # they reach the whole group; what to do about them is the parent's choice
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=lambda: (sys.stdin.buffer.read(), os._exit(1)), daemon=True).start()
    sys.stdout.write(json.dumps(told(lambda: collect_folder(Path(sys.argv[1]))[1])))
    sys.stdout.flush()
    os._exit(0)
