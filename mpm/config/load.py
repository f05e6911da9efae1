"""load: YAML file or dict, what it extends, overrides and smoke -> Experiment, or ConfigError with everything that is wrong."""

import json
from pathlib import Path as File
from typing import Any

from pydantic import ValidationError

from mpm.config.checks import check
from mpm.config.experiment import Experiment
from mpm.config.explain import Finding, findings, problems, shown
from mpm.config.measured import embed
from mpm.config.merge import extend, put
from mpm.config.names import GREEK, ROOT, Names, UnknownName
from mpm.config.nodes import BAD, Node, Origin, lines, read, read_file, wrap
from mpm.config.parameters import Binder, named
from mpm.config.partial import MISSING, Unknown, loose
from mpm.config.problems import ConfigError, Problem, brief, listed
from mpm.config.rules_stability import findings as map_findings
from mpm.config.schema_paths import Path
from mpm.config.vary import Vary

MOST_SETTINGS = 100


def load(source: str | File | dict[str, Any], overrides: dict[str, Any] | None = None, smoke: bool = False) -> Experiment:
    """Read and check a config.

    source      a YAML file, or a dict of the same shape
    overrides   {path: value}; short names count as paths, text is read as YAML ("2 mm", "[1, 2]"). An override of a swept parameter fixes it
    smoke       apply the config's own `smoke:` section first
    """
    found: list[Problem] = []
    root, text, path = gather(source, found)
    if root is None:
        raise ConfigError(found)
    given = settings(overrides or {}, found)
    named(root)
    wanted = smoke_settings(root)
    full = copy(root)
    if smoke and not wanted:
        found.append(root.origin.problem(root.line, root.column, "smoke", "the config has no smoke section", allowed="smoke: {path: value, ...}"))
    apply(full, (wanted if smoke else []) + given, found)
    orphan = any(one.path == "extends" for one in found)
    experiment, wrong = validate(full, orphan)
    found += wrong
    if wanted and not smoke and not orphan:  # the smoke form must be right too, although it is not wanted now
        trial = copy(root)
        apply(trial, wanted + given, found)
        found += validate(trial)[1]
    if experiment is not None:
        folder = path.parent if path else File()
        found += problems(full, [*embed(experiment, folder), *triangles(experiment, folder)])
    if found or experiment is None:
        raise ConfigError(found)
    experiment._source, experiment._path, experiment._tree = text, path, full
    return experiment


def triangles(experiment: Experiment, folder: File) -> list[Finding]:
    """Meshes that shapes name, read; and once they are known, what is then wrong with the whole."""
    meshes = [item for section in (experiment.bodies, experiment.tools) for item in section.values() if item.shape.kind == "mesh" and not item.shape.data]
    if not meshes:
        return []
    from mpm.config.meshes import embed as read

    return [*read(experiment, folder)] or [*check(experiment)]


def restore(resolved: dict[str, Any]) -> Experiment:
    """An experiment from its own `resolved()` form: checked before, so types are read again, and nothing is said about places."""
    return Experiment.model_validate(resolved)


def gather(source: str | File | dict[str, Any], found: list[Problem]) -> tuple[Node | None, str, File | None]:
    """Nodes, text and path of a source with all that it extends."""
    root: Node | None
    path: File | None = None
    seen: tuple[File, ...] = ()
    if isinstance(source, dict):
        origin, folder = Origin("<dict>"), File()
        root = wrap(source, origin, found)
        text = json.dumps(root.plain(), indent=2, ensure_ascii=False, default=str)
    else:
        path = File(source)
        root, wrong, text = read_file(path, str(source))
        found += wrong
        folder, origin = path.parent, Origin(str(source))
        seen = (path.resolve(),) if root is not None else ()
    if root is None or not isinstance(root.value, dict):
        if not found:
            said = "the file is empty" if root is None or root.value is None else "the config is not a mapping"
            found.append(Origin(origin.file, lines(text)).problem(1, 1, "", said, allowed=f"the sections {listed(list(Experiment.model_fields))}"))
        return None, text, path
    return extend(root, folder, ROOT, found, seen), text, path


def copy(root: Node) -> Node:
    """A root whose keys can be set without touching the original."""
    return Node(dict(root.value), root.origin, root.line, root.column, dict(root.keys))


Setting = tuple[str, Node, bool]  # name, value, whether the name itself has a place in a file


def settings(overrides: dict[str, Any], found: list[Problem]) -> list[Setting]:
    """Overrides as nodes whose origin says `--set path=value`."""
    made = []
    for name, value in overrides.items():
        said = value if isinstance(value, str) else brief(value)
        origin = Origin(f"--set {name}={said}"[:200])
        if isinstance(value, str):
            node, wrong = read(value, origin)
            found += [Problem(origin.file, 0, 0, name, one.message, one.given, one.allowed, one.suggestion) for one in wrong]
            node = unplaced(node, origin) if node is not None else Node(BAD if wrong else None, origin)
        else:
            node = wrap(value, origin, found)
        made.append((name, node, False))
    return made


def unplaced(node: Node, origin: Origin) -> Node:
    """The same data without lines and columns."""
    if isinstance(node.value, dict):
        return Node({key: unplaced(item, origin) for key, item in node.value.items()}, origin, keys=dict.fromkeys(node.value, (origin, 0, 0)))
    return Node([unplaced(item, origin) for item in node.value] if isinstance(node.value, list) else node.value, origin)


def smoke_settings(root: Node) -> list[Setting]:
    """The smoke section as settings that keep their places."""
    section = root.value.get("smoke")
    if section is None or not isinstance(section.value, dict):
        return []
    return [(name, node, True) for name, node in section.value.items()]


def apply(root: Node, wanted: list[Setting], found: list[Problem]) -> None:
    """Set every path; a parameter that is set does not vary any more."""
    if len(wanted) > MOST_SETTINGS:
        found.append(root.origin.problem(root.line, root.column, "smoke", f"{len(wanted)} settings", allowed=f"at most {MOST_SETTINGS}"))
        return
    names = None
    for name, node, placed in wanted:
        names = names or Names(loose(ROOT, Binder(root, ROOT).bind().plain()))
        try:
            path = names.target(name)
        except UnknownName as error:
            origin, line, column = root.value["smoke"].keys[name] if placed else (node.origin, 0, 0)
            spoken = f"smoke.{name}" if placed else name
            found.append(origin.problem(line, column, spoken, error.message, allowed=listed(error.allowed), suggestion=error.suggestion))
            continue
        except Unknown:
            continue
        put(root, path, node, ROOT)
        unfollow(root, path)
        if path[0] != "sweep" and "sweep" in root.value:
            fix(root, path, names)
        names = None  # what is set may make room for what comes next


def unfollow(root: Node, path: Path) -> None:
    """What is set follows from no formula any more."""
    section = root.value.get("formulas")
    if section is not None and isinstance(section.value, dict):
        said = ".".join(map(str, path))
        gone = [one for one in section.value if one == said or one.startswith(said + ".") or said.startswith(one + ".")]
        root.value["formulas"] = Node({one: node for one, node in section.value.items() if one not in gone}, section.origin)


def fix(root: Node, path: Path, names: Names) -> None:
    """Take a parameter that was set out of the sweep."""
    sweep = root.value["sweep"].plain()
    if not isinstance(sweep, dict):
        return
    varied: list[tuple[Path, str]] = [(("sweep", form), name) for form in ("axes", "derive") for name in mapping(sweep.get(form))]
    for form in ("zip", "points"):
        entries = found if isinstance(found := sweep.get(form), list) else []
        varied += [(("sweep", form, index), name) for index, entry in enumerate(entries) for name in mapping(entry)]
    for kind, design in mapping(sweep.get("sample")).items():
        varied += [(("sweep", "sample", kind, "ranges"), name) for name in mapping(mapping(design).get("ranges"))]
    removed = False
    for section, name in varied:
        try:
            swept = names.resolve(name)[0]
        except UnknownName:
            continue  # told when the sweep is read
        length = min(len(swept), len(path))
        if swept[:length] == path[:length]:
            put(root, (*section, name), Node(None, root.origin), ROOT)
            removed = True
    if removed:
        prune(root)


def mapping(value: Any) -> dict:
    """A mapping, or an empty one in place of anything else (what it should be is told by the models)."""
    return value if isinstance(value, dict) else {}


def prune(root: Node) -> None:
    """Drop forms of a sweep that lost their last parameter, and the sweep when nothing varies."""
    sweep = root.value["sweep"]
    for form in ("zip", "points"):
        if (entries := sweep.child(form)) is not None and isinstance(entries.value, list):
            entries.value[:] = [entry for entry in entries.value if entry.value]
    for kind, design in list(mapping(sweep.child("sample").value if sweep.child("sample") else None).items()):
        if (ranges := design.child("ranges")) is not None and not ranges.value:
            sweep.value["sample"].value.pop(kind)
    for form in ("axes", "zip", "points", "sample", "derive"):
        if (entries := sweep.child(form)) is not None and not entries.value and entries.value is not BAD:
            sweep.value.pop(form)
    if not set(sweep.value) - {"where"}:
        root.value.pop("sweep")


def validate(root: Node, orphan: bool = False) -> tuple[Experiment | None, list[Problem]]:
    """The experiment of a tree of nodes, and what is wrong with it: types, sections together, sweep.

    orphan   its base file cannot be read: what is missing may be there, so only what is wrong in itself is told
    """
    binder = Binder(root, ROOT)
    bound = binder.bind()
    raw = bound.plain()
    told = problems(root, binder.found)
    root = bound
    found: list[Finding] = []
    experiment: Any = None
    try:
        whole: Any = Experiment.model_validate(raw)
        experiment = whole
    except ValidationError as error:
        found += findings(error, ROOT)
        whole = loose(ROOT, raw)
    if orphan:
        return None, told + problems(root, [finding for finding in found if not finding.missing])
    found += check(whole)
    sweep = whole.sweep
    if sweep is not None and sweep is not MISSING:
        vary = Vary(sweep, Names(whole))
        try:
            vary.read()
        except Unknown:
            pass  # part of the sweep is wrong and told above
        found += vary.found
    found += map_findings(whole)
    return experiment, told + problems(root, found)


__all__ = ["GREEK", "load", "restore", "shown"]
