"""Do the tests bite? `python -m mpm.benchmarks.mutants [--only PATTERN] [--of N] [--seed S] [--minutes M]` changes one place of the product at a time
and runs the nearest tests. What was found is kept in docs/mutants.csv: the same command goes on where it was stopped. `why` says why a survivor may live.

Each module of CHOSEN gets its share of mutants: a comparison turned round, a sum made a difference, a product a quotient, a number doubled, `and` made `or`, a
`not` dropped. Which places is a matter of the seed and of the changed text, so an edit elsewhere in a module leaves its other mutants as they are.
A mutant is killed when a test fails, or when the tests take TIMES as long as without it. The product itself is not touched: the tests run over a copy.
Printed: a line a mutant, then by module the share that was killed; survivors with their line, to be judged: a test that is missing, or a change that no test
could see (EQUAL says of which kinds that is known). To try one again, delete its row.
Times     5 to 60 s a mutant; modules of PLAIN are tested uncompiled. Rows of mutants that are no longer in their module are dropped
Fails when: the tests of a module fail without a mutant, which is said
"""

import argparse
import ast
import csv
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "docs" / "mutants.csv"
COLUMNS = ("module", "line", "before", "after", "nth", "result", "why")
TIMES, PATIENCE = 5.0, 60.0  # as long as without a mutant, and seconds more, before one counts as killed
LARGE = 1e6  # numbers from here on are bounds that nothing meets
CHOSEN = {  # module: (mutants, the nearest tests)
    "mpm/materials/hencky.py": (6, "tests/materials/test_hencky.py tests/implicit/test_tangents.py"),
    "mpm/materials/neo_hookean.py": (5, "tests/materials/test_neo_hookean.py tests/implicit/test_tangents.py"),
    "mpm/materials/laws.py": (10, "tests/materials/test_laws.py"),
    "mpm/materials/radial.py": (10, "tests/materials/test_return_maps.py tests/materials/test_over_lanes.py tests/implicit/test_tangents.py"),
    "mpm/materials/clipped.py": (10, "tests/materials/test_return_maps.py tests/materials/test_over_lanes.py tests/materials/test_extremes.py"),
    "mpm/heat/exchange.py": (6, "tests/heat/test_meets.py tests/heat/test_surface.py tests/heat/test_exchange_kinds.py"),
    "mpm/heat/local.py": (8, "tests/heat/test_local.py"),
    "mpm/heat/programmes.py": (4, "tests/heat/test_meets.py tests/heat/test_exchange_kinds.py"),
    "mpm/integrate/timestep.py": (12, "tests/integrate/test_timestep.py"),
    "mpm/guards.py": (12, "tests/test_guarded_by_hand.py tests/test_guards.py"),
    "mpm/sweep/store.py": (10, "tests/sweep/test_store.py tests/sweep/test_batches.py"),
    "mpm/sweep/engine.py": (12, "tests/sweep/test_hands_out.py tests/sweep/test_engine.py tests/sweep/test_stopped.py tests/sweep/test_resources.py"),
    "mpm/sweep/resources.py": (6, "tests/sweep/test_resources.py"),
    "mpm/records/netcdf.py": (6, "tests/records/test_netcdf.py"),
    "mpm/config/units.py": (5, "tests/config/test_units.py tests/config/test_quantities.py"),
    "mpm/config/quantities.py": (6, "tests/config/test_units.py tests/config/test_quantities.py"),
    "mpm/config/measured.py": (6, "tests/config/test_measured.py"),
}
PLAIN = ("mpm/materials/hencky.py", "mpm/materials/neo_hookean.py", "mpm/materials/laws.py", "mpm/heat/local.py", "mpm/integrate/timestep.py")
EQUAL = "a bound that is never met (x < y for x <= y), a margin of round-off, a number that only a message shows, a size of buffers"
COMPARED = {ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Gt: ast.LtE, ast.GtE: ast.Lt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
COMPUTED = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}


@dataclass(frozen=True)
class Mutant:
    """One changed place: characters `start` to `end` of the file become `text`."""

    path: str
    line: int
    start: int
    end: int
    text: str
    before: str


def mutants(path: str, source: str) -> list[Mutant]:
    """Every mutant of a module, in the order of its places. Docstrings, annotations and what only names things stay."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))
    data, found = source.encode(), []

    def put(node: ast.expr, changed: ast.expr) -> None:
        start, end = starts[node.lineno - 1] + node.col_offset, starts[node.end_lineno - 1] + node.end_col_offset
        found.append(Mutant(path, node.lineno, start, end, f"({ast.unparse(changed)})", data[start:end].decode()))

    for node in computing(ast.parse(source)):
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARED:
            put(node, ast.Compare(node.left, [COMPARED[type(node.ops[0])]()], node.comparators))
        elif isinstance(node, ast.BinOp) and type(node.op) in COMPUTED and not textual(node):
            put(node, ast.BinOp(node.left, COMPUTED[type(node.op)](), node.right))
        elif isinstance(node, ast.BoolOp):
            put(node, ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values))
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            put(node, node.operand)
        elif isinstance(node, ast.Constant) and isinstance(node.value, float) and 0 < node.value < LARGE:
            put(node, ast.Constant(node.value * 2))
    return sorted(found, key=lambda mutant: (mutant.start, mutant.end))


def computing(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes of a tree, less annotations, formatted text and type unions."""
    yield tree
    for name, inner in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list") or isinstance(tree, ast.JoinedStr):
            continue
        for child in inner if isinstance(inner, list) else [inner]:
            if isinstance(child, ast.AST):
                yield from computing(child)


def textual(node: ast.BinOp) -> bool:
    return any(isinstance(side, ast.JoinedStr | ast.List) or (isinstance(side, ast.Constant) and isinstance(side.value, str)) for side in ast.walk(node))


def run(folder: Path, path: str, tests: str, limit: float) -> tuple[bool, float]:
    """Whether the tests pass over the copy, and how long they took; too long counts as not."""
    began = time.monotonic()
    environment = os.environ | {"PYTHONPATH": f"{folder}", "PYTHONDONTWRITEBYTECODE": "1"} | ({"NUMBA_DISABLE_JIT": "1"} if path in PLAIN else {})
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-n", "0", "-p", "no:cacheprovider", *tests.split()]
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, timeout=limit, check=False)
        return done.returncode == 0, time.monotonic() - began
    except subprocess.TimeoutExpired:
        return False, limit


def copy(folder: Path) -> None:
    """What the tests need, where `mpm` and `mpm_cli` are imported from."""
    for name in ("mpm", "tests", "configs", "cli", "docs"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "CONTRIBUTING.md"):
        shutil.copy(ROOT / name, folder)
    shutil.copytree(ROOT / "cli", folder / "mpm_cli", ignore=shutil.ignore_patterns("__pycache__"))


def named(path: str, source: str) -> list[tuple[tuple, Mutant]]:
    """(key, mutant) of every mutant of a module. The key is what is changed, and the how manieth of its like."""
    seen: dict[tuple, int] = {}
    every = []
    for mutant in mutants(path, source):
        like = (path, " ".join(mutant.before.split()), mutant.text)
        seen[like] = seen.get(like, -1) + 1
        every.append(((*like, str(seen[like])), mutant))
    return every


def chosen(path: str, source: str, wanted: int, seed: int) -> list[tuple[tuple, Mutant]]:
    """(key, mutant) of those that a seed picks, in the order of the file."""
    every = named(path, source)
    every.sort(key=lambda pair: hashlib.sha256(f"{seed} {pair[0]}".encode()).digest())
    return sorted(every[:wanted], key=lambda pair: pair[1].start)


def kept() -> dict[tuple, dict]:
    """Rows of the file of results by key."""
    if not KEPT.exists():
        return {}
    with open(KEPT, newline="", encoding="utf-8") as file:
        return {(row["module"], row["before"], row["after"], row["nth"]): row for row in csv.DictReader(file)}


def keep(rows: dict[tuple, dict]) -> None:
    """Write the file of results, by module and line."""
    with open(KEPT, "w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows(sorted(rows.values(), key=lambda row: (row["module"], int(row["line"]), row["after"])))


def study(folder: Path, path: str, picked: list, tests: str, rows: dict[tuple, dict], until: float) -> None:
    """Run the mutants of one module that have no row, until a time: over one file of tests after the other, until one fails."""
    place, took = folder / path, dict[str, float]()
    source = place.read_text(encoding="utf-8")
    for key, mutant in picked:
        if key in rows or time.monotonic() > until:
            continue
        data, survived = source.encode(), True
        for file in tests.split():
            if file not in took:
                sound, took[file] = run(folder, path, file, 3600.0)
                if not sound:
                    print(f"{path}: its tests ({file}) fail without a mutant", flush=True)
                    return
            place.write_bytes(data[: mutant.start] + mutant.text.encode() + data[mutant.end :])
            survived, _ = run(folder, path, file, TIMES * took[file] + PATIENCE)
            place.write_text(source, encoding="utf-8")
            if not survived:
                break
        rows[key] = dict(zip(COLUMNS, (path, mutant.line, key[1], mutant.text, key[3], "survived" if survived else "killed", ""), strict=True))
        keep(rows)
        print(f"{'SURVIVED' if survived else 'killed  '} {path}:{mutant.line}: {mutant.before} -> {mutant.text}", flush=True)


def main() -> None:
    words = argparse.ArgumentParser("python -m mpm.benchmarks.mutants", description="Change one place of the product at a time: do the nearest tests fail?")
    words.add_argument("--only", default="", help="modules whose path holds this text")
    words.add_argument("--of", type=int, default=1, help="times as many mutants")
    words.add_argument("--seed", type=int, default=1, help="which places are changed")
    words.add_argument("--minutes", type=float, default=1e6, help="begin no mutant after this time")
    given = words.parse_args()
    there = {key for path in CHOSEN for key, _ in named(path, (ROOT / path).read_text(encoding="utf-8"))}
    until, rows = time.monotonic() + 60 * given.minutes, {key: row for key, row in kept().items() if key in there}
    picked = {path: chosen(path, (ROOT / path).read_text(encoding="utf-8"), wanted * given.of, given.seed) for path, (wanted, _) in CHOSEN.items()}
    with tempfile.TemporaryDirectory(prefix="mpm-mutants-") as name:
        folder = Path(name)
        copy(folder)
        for path, (_, tests) in CHOSEN.items():
            if given.only in path:
                study(folder, path, picked[path], tests, rows, until)
    total = {"killed": 0, "survived": 0, "": 0}
    for path, keys in picked.items():
        found = [rows.get(key, {"result": ""})["result"] for key, _ in keys]
        print(f"{path:32} {found.count('killed'):3} of {len(found):3} killed, {found.count('')} to do")
        total = {name: count + found.count(name) for name, count in total.items()}
    done = total["killed"] + total["survived"]
    print(f"{total['killed']} of {done} mutants killed ({100 * total['killed'] / max(done, 1):.0f} %), {total['']} to do; survivors may be equal: {EQUAL}")


if __name__ == "__main__":
    main()
