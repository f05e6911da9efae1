"""One config over another: `extends`, overrides, the smoke section. Every node keeps the file and line it came from."""

from pathlib import Path as File
from typing import Any

from mpm.config.nodes import BAD, Node, read_file
from mpm.config.problems import Problem, near
from mpm.config.schema_paths import Path, Slot

MOST_BASES = 20


def merge(base: Node, over: Node, slot: Slot | None) -> Node:
    """`over` on `base`: mappings merge key by key, all else is replaced, null takes a key away. Another kind replaces the whole kind."""
    if not (isinstance(base.value, dict) and isinstance(over.value, dict)):
        return over
    if slot is not None and slot.menu and set(base.value) != set(over.value):
        return over
    merged = Node(dict(base.value), over.origin, over.line, over.column, dict(base.keys))
    for key, node in over.value.items():
        if node.value is None and key in merged.value:
            del merged.value[key], merged.keys[key]
        elif key in merged.value:
            merged.put(key, merge(merged.value[key], node, slot.step(key) if slot else None), over.keys[key])
        else:
            merged.put(key, node, over.keys[key])
    return merged


def extend(node: Node, folder: File, slot: Slot, problems: list[Problem], seen: tuple[File, ...] = ()) -> Node:
    """Resolve `extends: base.yaml`, relative to the file that says so; bases may extend further."""
    if not isinstance(node.value, dict) or "extends" not in node.value:
        return node
    said = node.value.pop("extends")
    node.keys.pop("extends")
    report = lambda message, **more: problems.append(said.origin.problem(said.line, said.column, "extends", message, **more))  # noqa: E731
    if said.value is BAD:
        return node
    if not isinstance(said.value, str) or not said.value or "\0" in said.value:
        report("expected the name of a file", allowed="extends: base.yaml")
        return node
    target = folder / said.value
    try:
        file = target.resolve()
    except (OSError, RuntimeError, ValueError) as error:
        report(f"cannot read the base file: {error}")
        return node
    if file in seen:
        chain = " -> ".join(item.name for item in (*seen[seen.index(file) :], file))
        report("the files extend each other in a circle", given=chain, allowed="a base that does not extend this file")
        return node
    if len(seen) > MOST_BASES:
        report(f"more than {MOST_BASES} files extend one another")
        return node
    if not file.is_file():
        there = [item.name for item in file.parent.glob("*.y*ml")] if file.parent.is_dir() else []
        report("there is no such file", given=repr(said.value), allowed="a file, relative to this one", suggestion=near(file.name, there))
        return node
    base, found, _ = read_file(file, str(target))
    problems.extend(found)
    if base is None or not isinstance(base.value, dict):
        if not found:
            report("the base file is not a mapping", given=repr(said.value))
        return node
    base = extend(base, target.parent, slot, problems, (*seen, file))
    brought(base, File(said.value).parent)
    return merge(base, node, slot)


def brought(base: Node, folder: File) -> None:
    """Files that a base names beside itself are named as from where it is extended."""
    output = base.child("output")
    measured = output.child("measured") if output else None
    for curve in measured.value.values() if measured and isinstance(measured.value, dict) else ():
        file = curve.child("file")
        if file is not None and isinstance(file.value, str) and file.value:
            file.value = str(folder / file.value)


def put(root: Node, path: Path, node: Node, slot: Slot | None) -> None:
    """Set the node at a path, making mappings on the way; null takes the key away. Another kind on the way is replaced."""
    here = root
    for index, key in enumerate(path[:-1]):
        below = here.child(key)
        under = slot.step(key) if slot else None
        following = path[index + 1]
        if below is None or not isinstance(below.value, dict | list):
            keep = {} if below is None or below.value != following else {str(following): Node({}, below.origin, below.line, below.column)}
            below = Node(keep, node.origin, node.line, node.column, {name: (node.origin, node.line, node.column) for name in keep})
        elif under is not None and under.menu and isinstance(below.value, dict) and following not in below.value:
            below = Node({}, node.origin, node.line, node.column)
        else:
            below = Node(type(below.value)(below.value), below.origin, below.line, below.column, dict(below.keys))
        if isinstance(below.value, list) != isinstance(following, int):
            return  # a list where a mapping should be, or the reverse: told when the tree is validated
        place(here, key, below)
        here, slot = below, under
    if node.value is None and isinstance(here.value, dict):
        here.value.pop(path[-1], None)
        here.keys.pop(str(path[-1]), None)
    else:
        place(here, path[-1], node, named=True)


def place(parent: Node, key: Any, node: Node, named: bool = False) -> None:
    """Set one entry of a mapping or a list; a new key is placed where its value is."""
    if isinstance(parent.value, list):
        parent.value[key] = node
    else:
        old = parent.keys.get(key)
        parent.put(key, node, (node.origin, node.line, node.column) if named or old is None else old)
