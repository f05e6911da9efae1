"""Small scenes that the tests of the core share. One set of physics for most of them, so that each dimension and transfer compiles once.

Tests with `pytest.mark.plain` run without the compiler, each module in a fork of tests/plain_server.py: their small scenes take a second in plain Python, where
compiling their physics would take twenty. tests/test_roles.py holds compiled and plain results together.
"""

import copy
import csv
import gc
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # read as numpy is imported: a worker a core, and threads of linear algebra that wait by spinning

import numpy as np
import pytest
from numba import config as numba_config

import mpm
from mpm import fingerprint, linking

# Bytecode is written, whatever the environment says: some two hundred processes start in these tests, and each would compile the package's source anew.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# What takes longest begins first, so that workers end together: minutes of processor in an empty environment, most of them compiling.
FIRST = (
    "tests/test_configs.py", "test_cooling.py", "test_roles.py", "test_simulation.py", "test_implicit_heat.py", "test_motion.py", "contact/test_walls.py",
    "test_over_lanes.py", "test_menus.py", "test_commands.py", "sweep/test_engine.py", "total/test_frame.py", "test_exchange_kinds.py",
    "test_point_problems.py", "test_step_threaded.py", "test_linking.py", "test_heat_problems.py", "point/test_mechanics.py", "test_stability.py",
    "test_together.py", "contact/test_tools.py", "contact/test_bodies.py",
)  # fmt: skip
REFERENCE = Path(__file__).parent / "reference"
DIRECTIONS = {1: 1, 2: 2, "axisymmetric": 2, 3: 3}
HOT, COLD = 400.0, 300.0
TRANSFERS = {
    "apic": ({"apic": {}}, {"apic": {}}),
    "flip": ({"flip": {}}, {"flip": {}}),
    "flip blend": ({"flip": {"blend": 0.05}}, {"flip": {"blend": 0.02}}),
    "pic": ({"pic": {}}, {"pic": {}}),
}  # velocity, temperature


def config(dimension=1, **sections):
    """A warm elastic body of 3 cells a direction, off the grid lines, in air as warm as itself: nothing happens until a test changes something."""
    D = DIRECTIONS[dimension]
    lower, upper = [0.6] * D, [1.35] * D
    if dimension == "axisymmetric":
        lower[0], upper[0] = 0.0, 0.85
    data = {
        "grid": {"dimension": dimension, "size": [2.0] * D, "cell": 0.25},
        "bodies": {"body": {"shape": {"box": {"lower": lower, "upper": upper}}, "temperature": HOT, "material": "solid"}},
        "materials": {
            "solid": {
                "density": 2.0,
                "elastic": {"hencky": {"lam": 3.0, "mu": 2.0}},
                "heat": {"fourier": {"kappa": 0.1, "alpha": 1.5}},
                "expansion": {"modulus": {"gamma": 0.0, "reference": HOT}},
                "heating": {"elastic": {}},
            }
        },
        "surfaces": [{"of": "body", "convection": {"beta": 0.5, "outside": HOT}}],
        "time": {"end": 0.5},
        "output": {"every": 0.1},
    }
    return data | copy.deepcopy(sections)


def experiment(dimension=1, changes=None, drop=(), **sections):
    """`config` with whole `sections` replaced, then `changes` by path (short names allowed); `drop` lists parts of the material to leave out."""
    data = config(dimension, **sections)
    for part in drop:
        if part == "surfaces":
            data["surfaces"] = []
        else:
            del data["materials"]["solid"][part]
    return mpm.load(data, changes or {})


def methods(transfer, gradient="mls"):
    """The method section of a pair of transfers by name."""
    velocity, temperature = TRANSFERS[transfer]
    return {"transfer": velocity, "temperature": temperature, "gradient": gradient}


def play(experiment, prepare=None, beat=None):
    """Build, let `prepare(scene)` change the arrays, simulate: (scene at its end, run)."""
    from mpm.scene.build import build
    from mpm.simulation import simulate

    scene = build(experiment)
    if prepare is not None:
        prepare(scene)
    return scene, simulate(scene, beat)


def table(name):
    """A reference table as a list of {column: float or text}."""
    with open(REFERENCE / name, newline="") as file:
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def order(errors, ratio=2.0):
    """Least-squares order of errors at cells that shrink by `ratio`."""
    return -np.polyfit(np.arange(len(errors)) * np.log(ratio), np.log(errors), 1)[0]


@pytest.fixture(scope="session")
def core():
    """The helpers of this file: tests are not a package."""
    return SimpleNamespace(
        DIRECTIONS=DIRECTIONS,
        HOT=HOT,
        COLD=COLD,
        TRANSFERS=TRANSFERS,
        config=config,
        experiment=experiment,
        methods=methods,
        play=play,
        table=table,
        order=order,
    )


def pytest_configure(config):
    if place := os.environ.pop("MPM_TEST_REPORTS", None):
        config.pluginmanager.register(Told(config, place))


class Told:
    """In the child of a plain module: reports, a line each."""

    def __init__(self, config, place):
        self.config, self.place = config, place

    def pytest_runtest_logreport(self, report):
        data = self.config.hook.pytest_report_to_serializable(config=self.config, report=report)
        with open(self.place, "a") as file:
            file.write(json.dumps(data) + "\n")


def within_its_rooms(kernel, function):
    """Every kernel that a test compiles holds only rooms that its cache is named after, or an edit would leave it stale."""
    own, other = (one.__module__.split(".") if one else [""] for one in (kernel, function))
    assert other[0] != "mpm" or other[1] in fingerprint.contained(own[1]), f"{'.'.join(own)} holds {'.'.join(other)}"


linking.listeners.append(within_its_rooms)


def pytest_collection_finish():
    """What was imported and collected lives to the end: the garbage collector need not look through it again and again."""
    gc.collect()
    gc.freeze()


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: next((place for place, name in enumerate(FIRST) if item.path.as_posix().endswith(f"/{name}")), len(FIRST)))


def pytest_runtest_protocol(item, nextitem):
    """A plain test is reported as the child of its module reported it."""
    if item.get_closest_marker("plain") is None or numba_config.DISABLE_JIT:
        return None
    children = item.session.__dict__.setdefault("plain_modules", {})
    if item.path not in children:
        plain = [one.nodeid for one in item.session.items if one.path == item.path and one.get_closest_marker("plain")]
        children[item.path] = without_compiler(item.config, plain)
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    for report in children[item.path][item.nodeid]:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    item.session._setupstate.teardown_exact(nextitem)  # what the test before left for tests of this folder
    return True


def without_compiler(config, tests):
    """Run tests of one module without the compiler: their reports."""
    if not hasattr(config, "plain_server"):
        config.plain_server = subprocess.Popen([sys.executable, Path(__file__).parent / "plain_server.py"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                               text=True, cwd=config.rootpath, env=os.environ | {"NUMBA_DISABLE_JIT": "1"})  # fmt: skip
    server = config.plain_server
    with tempfile.NamedTemporaryFile("r") as told, tempfile.NamedTemporaryFile("r") as printed:
        asked = {"arguments": ["--numprocesses=0", "-m", config.option.markexpr, *tests], "reports": told.name, "output": printed.name}
        print(json.dumps(asked), file=server.stdin, flush=True)
        server.stdout.readline()
        reports = {test: [] for test in tests}
        for line in told:
            report = config.hook.pytest_report_from_serializable(config=config, data=json.loads(line))
            reports[report.nodeid].append(report)
        if not all(reports.values()):
            raise RuntimeError(f"tests without the compiler did not run to their end\n{printed.read()[-3000:]}")
    return reports


PLAIN = """
import json, sys
from mpm.config import load
from mpm.runner import run_point
for line in sys.stdin:
    config = load(json.loads(line))
    run = run_point(config, compare=config.exact is not None)
    series = {name: values.tolist() for name, values in run.series.items()}
    found = {"kind": run.outcome.kind, "message": run.outcome.message, "times": run.times.tolist(), "series": series, "facts": run.facts,
             "finals": {name: float(value) for name, value in run.finals.items()}}
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
