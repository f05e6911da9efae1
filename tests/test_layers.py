"""The house rules that a reader cannot see at a glance, read from the syntax trees: imports go down only, flags, sizes, lazy front doors."""

import ast
import functools
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "mpm"
MODULES = sorted(PACKAGE.rglob("*.py"))
STANDARD = set(sys.stdlib_module_names)

# Rooms by layer. A room may import rooms below its own layer, and its own modules; of its own layer only what PEERS names.
LAYERS = {
    "cache": 0, "fingerprint": 0, "shortcuts": 0, "linking": 0, "jit": 0, "compiling": 0, "text": 0, "triangles": 0,
    "lanes": 0, "isotropic": 0, "memory": 0, "tensors": 0, "outcome": 0, "state": 0, "warned": 0,
    "basis": 1, "materials": 1, "transfer": 1, "boundary": 1, "heat": 1, "sources": 1,
    "diagnostics": 2, "follow": 2, "implicit": 2, "integrate": 2, "total": 2, "contact": 2,
    "error": 2, "inflow": 3, "fields": 3, "guards": 3, "observe": 3, "simulation": 3, "warming": 3, "rigid": 3, "point": 3,
    "config": 4, "records": 4, "scene": 4, "starting": 4,
    "ahead": 5, "reference": 5, "runner": 5, "review": 5, "reduce": 5, "costs": 5, "sweep": 5, "verification": 5,
    "study": 6, "plots": 6, "fit": 6, "sensitivity": 6, "opened": 6,
    "exports": 7, "movies": 7, "reports": 8, "notebook": 9, "benchmarks": 9,
}  # fmt: skip
PEERS = {
    "compiling": {"cache", "fingerprint"}, "linking": {"compiling", "shortcuts"},
    "jit": {"cache", "fingerprint", "linking"}, "state": {"outcome"}, "lanes": {"jit"}, "tensors": {"jit", "lanes"}, "isotropic": {"jit", "lanes", "tensors"},
    "transfer": {"basis", "boundary"}, "heat": {"materials"},  # spreads weights, counts directions; laws of temperature
    "scene": {"config"},  # Config -> Scene
    "integrate": {"diagnostics"}, "total": {"integrate", "diagnostics"}, "contact": {"integrate"}, "implicit": {"contact", "integrate", "total", "diagnostics"},
    "error": {"diagnostics"}, "simulation": {"observe", "guards", "warming"}, "observe": {"fields"},
    "reduce": {"costs"}, "ahead": {"costs"}, "runner": {"ahead", "verification", "costs", "reduce", "review"},
    "sweep": {"runner", "verification", "costs", "reduce"}, "study": {"plots"}, "opened": {"plots"},
}  # fmt: skip
LEAVES = {"mpm.records.variables", "mpm.text", "mpm.triangles", "mpm.warned"}  # anyone may import it
GEOMETRY = {"mpm.scene.shapes", "mpm.scene.cut", "mpm.scene.sides", "mpm.scene.sphere", "mpm.scene"}  # pure geometry, below rigid heat
COMPUTING = 3  # the last layer that may know only numbers


def room(path):
    place = path.relative_to(PACKAGE)
    return place.parts[0] if len(place.parts) > 1 else place.stem


@functools.cache
def parsed(path):
    """Its syntax tree; five tests ask for each."""
    return ast.parse(path.read_text(encoding="utf-8"))


def imports(path):
    """(module, whether at the top level) of every import, relative ones made absolute, `from mpm import x` as mpm.x."""
    package = ("mpm", *path.relative_to(PACKAGE).parts[:-1])
    tree = parsed(path)
    top = set(map(id, tree.body))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, id(node) in top) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join((*package[: len(package) - node.level + 1], *([node.module] if node.module else []))) if node.level else node.module
            if base == "mpm":
                yield from ((f"mpm.{alias.name}", id(node) in top) for alias in node.names)
            else:
                yield base, id(node) in top


def known(path):
    return room(path) in LAYERS


def test_every_room_has_a_layer():
    assert {room(path) for path in MODULES} - set(LAYERS) == {"__init__"}


def test_imports_go_down():
    upward = []
    for path in (path for path in MODULES if known(path)):
        own = room(path)
        for module in {module for module, _ in imports(path) if module.startswith("mpm.")} - LEAVES - (GEOMETRY if own == "rigid" else set()):
            other = module.split(".")[1]
            if not (other == own or LAYERS[other] < LAYERS[own] or other in PEERS.get(own, ())):
                upward.append(f"{path.relative_to(ROOT)} (layer {LAYERS[own]}) imports {module} (layer {LAYERS[other]})")
    assert not upward


def test_the_computing_layers_know_only_numbers():
    more = {"rigid": {"scipy"}, "implicit": {"scipy"}, "linking": {"llvmlite"}, "shortcuts": {"llvmlite"}, "lanes": {"llvmlite"}}
    foreign = []
    for path in (path for path in MODULES if known(path) and LAYERS[room(path)] <= COMPUTING):
        allowed = STANDARD | {"numpy", "numba", "mpm"} | more.get(room(path), set())
        foreign += [f"{path.relative_to(ROOT)} imports {module}" for module, _ in imports(path) if module.split(".")[0] not in allowed]
    assert not foreign


def test_config_and_records_do_not_know_each_other():
    for path in MODULES:
        for module, _ in imports(path):
            if room(path) == "records":
                assert not module.startswith("mpm.config"), path
            if room(path) == "config" and module.startswith("mpm.records"):
                assert module in LEAVES, path


def test_plots_see_datasets_only():
    allowed = STANDARD | {"numpy", "matplotlib", "h5py", "xarray", "mpm"}  # h5py: whether a file is a dataset at all
    for path in MODULES:
        if room(path) == "plots":
            for module, _ in imports(path):
                assert module.split(".")[0] in allowed and (not module.startswith("mpm.") or module in LEAVES or module.startswith("mpm.plots")), (path, module)


def calls(tree):
    return (node for node in ast.walk(tree) if isinstance(node, ast.Call))


def test_no_dangerous_flags_and_no_code_as_data():
    """fastmath=True would remove isnan; parallel=True would make sums depend on threads; eval and pickle have no place here; njit only in jit.py."""
    for path in MODULES:
        for call in calls(parsed(path)):
            for keyword in call.keywords:
                assert not (keyword.arg in ("fastmath", "parallel") and isinstance(keyword.value, ast.Constant) and keyword.value.value is True), path
            name = call.func.id if isinstance(call.func, ast.Name) else ""
            assert name not in ("eval", "exec"), f"{name} in {path}"
            assert name != "njit" or path.name == "jit.py", path
        assert not {"pickle", "dill", "cloudpickle", "marshal"} & {module.split(".")[0] for module, _ in imports(path)}, path


def test_errors_are_not_swallowed():
    for path in MODULES:
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.ExceptHandler):
                broad = node.type is None or (isinstance(node.type, ast.Name) and node.type.id in ("Exception", "BaseException"))
                assert not (broad and all(isinstance(inner, ast.Pass) for inner in node.body)), f"{path}:{node.lineno}"


def test_modules_are_short_and_say_what_they_are():
    for path in MODULES + sorted((ROOT / "cli").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        assert len(text.splitlines()) <= 300, path
        assert not text or ast.get_docstring(parsed(path)), f"{path} has no docstring"


HEAVY = {"numba", "xarray", "scipy", "matplotlib", "pint", "h5netcdf", "h5py", "pandas", "pydantic"}


@pytest.mark.parametrize("module", ["mpm", "cli.main"])
def test_the_front_doors_are_light(module):
    """`import mpm` and `mpm --help` load nothing heavy."""
    code = f"import sys, importlib; importlib.import_module({module!r}); print(*sorted({HEAVY!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []


@pytest.mark.parametrize("folder", sorted({path.parent for path in MODULES} - {PACKAGE}), ids=lambda folder: folder.name)
def test_a_room_names_its_files(folder):
    """The docstring of a room is its index: no file is left out, and none is named in its list that is not there."""
    said = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8")))
    files = {path.stem for path in folder.glob("*.py")} - {"__init__"}
    assert {name for name in files if not re.search(rf"\b{name}\b", said)} == set()
    _, _, listed = said.partition("Further files\n")
    assert {line.split()[0] for line in listed.splitlines() if line.startswith("    ")} <= files
