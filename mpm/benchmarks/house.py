"""The house in numbers, of any checkout: `python -m mpm.benchmarks.house [FOLDER …]` prints one column a folder, so that before stands beside after.

Read from syntax trees: modules (median and largest, in lines), functions (95th percentile and largest: lines, arguments, cyclomatic complexity as McCabe
counts it, 1 + branches), circles (groups of modules that reach one another by imports, late ones within functions too),
public functions and classes without a docstring (the kinds of a role have the role's), and public functions whose docstring names a unit.
"""

import argparse
import ast
import re
import statistics
from collections.abc import Iterator
from pathlib import Path

BRANCHES = (ast.If, ast.For, ast.While, ast.IfExp, ast.ExceptHandler, ast.comprehension, ast.match_case, ast.Assert)
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
UNIT = re.compile(r"\[[^\]]*\]|\b(m|s|K|Pa|J|W|kg|1|m2|m3|°C)\b(?=[,;:.)\]]|\s*$)", re.M)


def inner(function: ast.AST) -> Iterator[ast.AST]:
    """All nodes of a function, without those of functions defined in it."""
    for child in ast.iter_child_nodes(function):
        if not isinstance(child, FUNCTIONS):
            yield child
            yield from inner(child)


def complexity(function: ast.AST) -> int:
    """McCabe's number: 1 + branches; each `and`, `or` beyond the first operand is a branch."""
    nodes = list(inner(function))
    return 1 + sum(isinstance(node, BRANCHES) for node in nodes) + sum(len(node.values) - 1 for node in nodes if isinstance(node, ast.BoolOp))


def arguments(function: ast.FunctionDef) -> int:
    given = function.args
    return len(given.posonlyargs) + len(given.args) + len(given.kwonlyargs)


def circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Groups of two modules or more that reach one another."""

    def reach(start: str) -> set[str]:
        seen, stack = set(), [start]
        while stack:
            for other in edges[stack.pop()] - seen:
                seen.add(other)
                stack.append(other)
        return seen

    reached = {name: reach(name) for name in edges}
    groups = {frozenset(other for other in reached[name] if name in reached[other]) for name in edges if name in reached[name]}
    return sorted(sorted(group) for group in groups)


def imported(tree: ast.Module, names: set[str]) -> set[str]:
    """Modules of `names` that a module imports, at its top level or later."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found & names


def measure(folder: Path) -> dict[str, str]:
    """Rows of the table: what is counted -> the count, as text."""
    texts = {".".join(path.relative_to(folder).with_suffix("").parts): path.read_text(encoding="utf-8") for path in (folder / "mpm").rglob("*.py")}
    trees = {name: ast.parse(text) for name, text in texts.items()}
    lines = {name: len(text.splitlines()) for name, text in texts.items()}
    functions = [(f"{name}.{node.name}", node) for name, tree in trees.items() for node in ast.walk(tree) if isinstance(node, FUNCTIONS)]
    public = [
        node
        for tree in trees.values()
        for node in [*tree.body, *(inside for outer in tree.body if isinstance(outer, ast.ClassDef) for inside in outer.body)]
        if isinstance(node, (*FUNCTIONS, ast.ClassDef)) and not node.name.startswith("_")
        if not any("register" in ast.unparse(decorator) for decorator in node.decorator_list)
    ]
    rows = {"modules": f"{len(trees)}", "lines of a module, median; largest": f"{statistics.median(lines.values()):.0f}; {largest(lines)}"}
    for what, size, many in (("lines", lambda node: node.end_lineno - node.lineno + 1, 60), ("arguments", arguments, 10), ("complexity", complexity, 10)):
        sizes = {name: size(node) for name, node in functions}
        rows[f"{what} of a function, 95 %; largest"] = f"{sorted(sizes.values())[int(0.95 * len(sizes))]}; {largest(sizes)}"
        rows[f"functions with more than {many} {what}"] = f"{sum(count > many for count in sizes.values())}"
    rows["functions called _"] = f"{sum(node.name == '_' for _, node in functions)} of {len(functions)}"
    found = circles({name: imported(tree, set(trees)) - {name} for name, tree in trees.items()})
    rows["circles"] = "; ".join(" ".join(group) for group in found) or "none"
    rows["public without docstring"] = f"{sum(ast.get_docstring(node) is None for node in public)} of {len(public)}"
    stated = [ast.get_docstring(node) for node in public if isinstance(node, FUNCTIONS) and ast.get_docstring(node)]
    rows["public functions that name a unit"] = f"{sum(bool(UNIT.search(text)) for text in stated)} of {len(stated)}"
    return rows


def largest(sizes: dict[str, int]) -> str:
    name = max(sizes, key=lambda one: sizes[one])
    return f"{sizes[name]} ({name.removeprefix('mpm.')})"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m mpm.benchmarks.house", description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", type=Path, default=[Path()], metavar="FOLDER", help="checkouts; the current folder unless given")
    folders = parser.parse_args().folders
    for folder in folders:
        if next((folder / "mpm").glob("*.py"), None) is None:
            parser.error(f"{folder} is no checkout: there is no Python in {folder / 'mpm'}")
    columns = [measure(folder) for folder in folders]
    for what in columns[0]:
        print(f"{what:44}", " | ".join(f"{column[what]:60}" for column in columns))


if __name__ == "__main__":
    main()
