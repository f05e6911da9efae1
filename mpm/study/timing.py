"""Time of runs, fairly.

Every setting is warmed first (compiled or loaded, untimed); then whole rounds, A, B, C, A, B, C, so that a busy spell of the machine hits all alike. A timing
is that of `run_point` without its comparison with the exact solution, set-up included; short runs are repeated within a timing until it lasts LEAST.
Processor and wall time are both kept; on a shared machine the smallest processor time of several rounds is what says most about the method.
Compiling is timed apart: a fresh process with an empty cache, once a kind of method.

What was timed stays in OUT/timing.json, rewritten whole; an interrupted chart goes on in the round where it stopped. Timings of other source are dropped.
"""

import json
import math
import os
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpm.records.netcdf import write_whole
from mpm.records.provenance import machine, now
from mpm.sweep.report import Reporter

Halted = Callable[[], bool]  # whether it was asked to stop

LEAST = 0.02  # s that a timing lasts at least
WRITE = 5.0  # s between two writes of the file
ABREAST = 2  # compilations at a time
UNCOMPILED = ("output", "time", "title", "chart", "sweep", "smoke")
COLD = """
import json, sys
from mpm.config import load
from mpm.runner import run_point
run_point(load(json.load(sys.stdin)), compare=False)
"""


def compiled_source() -> str:
    """Hash of the rooms that are compiled: what a time depends on."""
    from mpm.fingerprint import contained, hash_of

    return hash_of(sorted(contained("simulation") | contained("rigid") | contained("point")))


class Stopped(Exception):
    """Timing was asked to stop; what was timed is on disk."""


@dataclass
class Timings:
    """What was timed: seconds by run id, a mapping a round; seconds of compiling by method; lines of peers by round."""

    path: Path
    source: str = field(default_factory=compiled_source)
    number: dict[str, int] = field(default_factory=dict)
    rounds: list[dict[str, Any]] = field(default_factory=list)
    compiling: dict[str, float] = field(default_factory=dict)
    written: float = 0.0

    @classmethod
    def at(cls, path: Path) -> "Timings":
        """Those in a file, if this source made them."""
        found = cls(path)
        try:
            old = json.loads(path.read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError):
            return found
        if old.get("source") == found.source:
            found.number, found.rounds, found.compiling = old["number"], old["rounds"], old["compiling"]
        return found

    def write(self, force: bool = True) -> None:
        """To disk; now and then unless forced."""
        if force or time.monotonic() - self.written > WRITE:
            data = {"source": self.source, "machine": machine(), "number": self.number, "rounds": self.rounds, "compiling": self.compiling}
            write_whole(self.path, json.dumps(data, indent=1).encode())
            self.written = time.monotonic()


def timed(points: dict[str, Any], labels: dict[str, str], repeats: int, path: Path, reporter: Reporter, peers: dict[str, str], halted: Halted) -> Timings:
    """Seconds of every point in `repeats` rounds; `halted()` is asked between two timings."""
    from mpm.runner import run_point, warm

    found = Timings.at(path)
    due = [k for k in range(repeats) if k >= len(found.rounds) or unfinished(found.rounds[k], points, peers)]
    reporter.start(repeats * (len(points) + len(peers)), sum(len(one["cpu"]) + len(one["peers"]) for one in found.rounds[:repeats]), 1)
    if due:
        for run_id, point in points.items():
            stop(halted, found)
            reporter.beat({labels[run_id]: 0.0})
            warm(point)
    for k in due:
        if k >= len(found.rounds):
            found.rounds.append({"at": now(), "load": os.getloadavg()[0], "wall": {}, "cpu": {}, "peers": {}})
        one = found.rounds[k]
        for run_id, point in points.items():
            if run_id in one["cpu"]:
                continue
            stop(halted, found)
            number = found.number.get(run_id)
            if number is None:
                number = found.number[run_id] = max(1, math.ceil(LEAST / max(1e-9, clock(run_point, point, 1)[0])))
            one["wall"][run_id], one["cpu"][run_id] = clock(run_point, point, number)
            reporter.finished(f"round {k + 1}, {labels[run_id]}", {"status": 0, "steps": number, "wall_time": one["wall"][run_id]}, False)
            found.write(False)
        for name, command in peers.items():
            if name not in one["peers"]:
                stop(halted, found)
                one["peers"][name] = peer(command)
                reporter.finished(f"round {k + 1}, {name}", {"status": 0, "steps": len(one["peers"][name]), "wall_time": 0.0}, False)
        found.write()
    return found


def unfinished(one: dict, points: dict[str, Any], peers: dict[str, str]) -> bool:
    """Whether a round has something left."""
    return any(run_id not in one["cpu"] for run_id in points) or any(name not in one["peers"] for name in peers)


def stop(halted: Halted, found: Timings) -> None:
    """Leave, with what was timed on disk, if asked to."""
    if halted():
        found.write()
        raise Stopped


def clock(run_point: Callable[..., Any], point: Any, number: int) -> tuple[float, float]:
    """(wall, processor) seconds of one run, over `number` runs."""
    wall, cpu = time.perf_counter(), time.process_time()
    for _ in range(number):
        run_point(point, compare=False)
    return (time.perf_counter() - wall) / number, (time.process_time() - cpu) / number


def peer(command: str) -> list[dict]:
    """The JSON lines of another program: each at least {seconds, error}, best {peer, unknowns, cpu, wall} too."""
    done = subprocess.run(shlex.split(command), capture_output=True, text=True, check=False)
    rows = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode or not rows:
        said = (done.stderr.strip().splitlines() or ["no line of JSON"])[-1]
        return [{"failed": said[:300]}]
    return rows


def compiled(points: dict[str, Any], path: Path, reporter: Reporter, halted: Halted) -> Timings:
    """Processor seconds of import, compilation and one run, by method, in fresh processes with empty caches; methods of one `kind` share it.

    ABREAST processes at a time: what is kept is each one's own processor time, of which a neighbour on another core takes little.
    """
    found = Timings.at(path)
    kinds = {method: kind(point) for method, point in points.items()}
    known = {kinds[method]: seconds for method, seconds in found.compiling.items() if method in kinds}
    due: dict[str, str] = {}
    for method, one in kinds.items():
        if one not in known:
            due.setdefault(one, method)
    with ThreadPoolExecutor(ABREAST) as pool:
        running = {pool.submit(cold, points[method], halted): one for one, method in due.items()}
        for future in as_completed(running):
            seconds, said = future.result()
            one = running[future]
            reporter.beat({f"compiling {due[one]}": 0.0})
            if seconds is not None:
                found.compiling[due[one]] = known[one] = seconds
                found.write()
            elif said:
                reporter.note(f"{due[one]}: compiling apart failed: {said}")
    stop(halted, found)
    found.compiling |= {method: known[one] for method, one in kinds.items() if one in known}
    found.write()
    return found


def cold(point: Any, halted: Halted) -> tuple[float | None, str]:
    """(processor seconds of one run in a fresh process with an empty cache, ""), or (None, what went wrong); (None, "") where it was asked to stop."""
    if halted():
        return None, ""
    with tempfile.TemporaryDirectory(prefix="mpm-cold-") as folder, tempfile.TemporaryFile() as said:
        surroundings = os.environ | {"MPM_CACHE_DIR": folder}
        started = subprocess.Popen([sys.executable, "-c", COLD], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said, env=surroundings)
        assert started.stdin is not None  # a pipe
        started.stdin.write(json.dumps(point.resolved()).encode())
        started.stdin.close()
        while True:  # wait4 tells this child's own time, which the sum over all children could not
            child, status, used = os.wait4(started.pid, os.WNOHANG)
            if child:
                break
            if halted():
                started.kill()
            time.sleep(0.05)
        started.returncode = os.waitstatus_to_exitcode(status)
        if started.returncode == 0:
            return used.ru_utime + used.ru_stime, ""
        said.seek(0)
        lines = said.read().decode(errors="replace").strip().splitlines()
        return None, "" if halted() else (lines or ["no word"])[-1][:200]


def kind(experiment: Any) -> str:
    """What decides which code is compiled: the names in a config, without its numbers. Transfers of temperature differ in numbers, all but XPIC."""

    def names(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: names(inner) for key, inner in value.items() if inner is not None and key not in UNCOMPILED}
        return [names(inner) for inner in value] if isinstance(value, list) else value if isinstance(value, str) else ""

    found = names(experiment.resolved())
    found["grid"]["dimension"] = str(experiment.grid.dimension)
    found["method"]["temperature"] = "xpic" if "xpic" in found["method"]["temperature"] else ""
    return json.dumps(found, sort_keys=True)
