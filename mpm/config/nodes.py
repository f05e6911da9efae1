"""Node: a config's data with the place of every value and key, before it is validated.

`read` makes nodes from YAML 1.2 text, `wrap` from Python data. What a config may not hold is reported here: tags, anchors,
aliases, duplicate keys, NaN, integers too long to parse, more than 20 levels, more than 1 MiB, several documents. Bad values become
`BAD`, so that the rest is still checked.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpm.config.problems import Problem, brief, near
from mpm.config.scalars import scalar
from mpm.text import escaped, joined

MOST_BYTES = 1 << 20
MOST_DEPTH = 20
MOST_VALUES = 30_000  # the parser takes 10 to 20 us for each
BREAK = re.compile(r"\r\n|\r|\n")


class Bad:
    """A value that is already reported; no further check looks at it."""

    def __repr__(self) -> str:
        return "BAD"


BAD = Bad()


@dataclass(frozen=True)
class Origin:
    """Where text comes from: a file's name as the user knows it, and its lines for the carets."""

    file: str
    lines: tuple[str, ...] = ()

    def problem(self, line: int, column: int, path: str, message: str, **more: str) -> Problem:
        """A Problem here."""
        text = self.lines[line - 1] if 0 < line <= len(self.lines) else ""
        return Problem(self.file, line, column, path, message, text=text, **more)


@dataclass
class Node:
    """A value and its place: `value` is a dict of nodes, a list of nodes or a scalar; `keys` has the place of each key."""

    value: Any
    origin: Origin
    line: int = 0
    column: int = 0
    keys: dict[str, tuple[Origin, int, int]] = field(default_factory=dict)

    def plain(self) -> Any:
        """The data alone."""
        if isinstance(self.value, dict):
            return {key: child.plain() for key, child in self.value.items()}
        return [child.plain() for child in self.value] if isinstance(self.value, list) else self.value

    def child(self, key: Any) -> "Node | None":
        """The node under a key or an index, or None."""
        if isinstance(self.value, dict):
            return self.value.get(key)
        if isinstance(self.value, list) and isinstance(key, int) and 0 <= key < len(self.value):
            return self.value[key]
        return None

    def put(self, key: str, node: "Node", place: tuple[Origin, int, int]) -> None:
        """Set a key of a mapping."""
        self.value[key] = node
        self.keys[key] = place


class Builder:
    """Nodes from the events of ruamel's parser, without recursion."""

    def __init__(self, origin: Origin):
        self.origin = origin
        self.problems: list[Problem] = []
        self.stack: list[Node] = []
        self.pending: list[tuple[str | None, tuple[int, int]] | None] = []  # for each open mapping: the key that waits for its value
        self.under: list[Any] = []  # for each open collection: its key in the one around it
        self.root: Node | None = None
        self.count = 0

    def report(self, line: int, column: int, message: str, **more: str) -> None:
        """Tell a problem at a line and column, with the path of where we are."""
        path = ".".join(str(key) for key in self.path()[:8])
        self.problems.append(self.origin.problem(line, column, path, message, **more))

    def path(self) -> list[Any]:
        """Keys from the root to where we are."""
        here = self.here()
        return [key for key in [*self.under[1:], here] if key is not None]

    def here(self) -> Any:
        """The key or index that the next value is for."""
        if not self.stack:
            return None
        if isinstance(self.stack[-1].value, list):
            return len(self.stack[-1].value)
        waiting = self.pending[-1]
        return waiting[0] if waiting else None

    def add(self, node: Node) -> None:
        """Put a finished scalar or a fresh collection where it belongs."""
        if not self.stack:
            self.root = node
            return
        parent = self.stack[-1]
        if isinstance(parent.value, list):
            parent.value.append(node)
            return
        waiting = self.pending[-1]
        if waiting is None:
            self.pending[-1] = (self.name(node, parent), (node.line, node.column))
            return
        name, place = waiting
        if name is not None:
            parent.put(name, node, (self.origin, *place))
        self.pending[-1] = None

    def name(self, node: Node, parent: Node) -> str | None:
        """The text of a key; None if it is none or is there already."""
        if not isinstance(node.value, str):
            if node.value is not BAD:
                self.report(node.line, node.column, "a key must be plain text")
            return None
        if node.value in parent.value:
            _, line, _ = parent.keys[node.value]
            self.report(node.line, node.column, f"the key {brief(node.value)} is here twice", given=f"first in line {line}", allowed="each key once")
            return None
        return node.value

    def feed(self, event: Any) -> bool:
        """Take one event; False to stop reading."""
        line, column = event.start_mark.line + 1, event.start_mark.column + 1
        kind = type(event).__name__
        if kind == "DocumentStartEvent" and self.root is not None:
            self.report(line, column, "a second document begins here", allowed="one document a file")
            return False
        if kind.endswith(("StartEvent", "ScalarEvent", "AliasEvent")) and not kind.startswith(("Stream", "Document")):
            return self.open(event, kind, line, column)
        if kind in ("MappingEndEvent", "SequenceEndEvent"):
            self.stack.pop()
            self.pending.pop()
            self.under.pop()
        return True

    def open(self, event: Any, kind: str, line: int, column: int) -> bool:
        """A scalar, an alias, or the beginning of a collection."""
        self.count += 1
        if self.count > 2 * MOST_VALUES:
            self.report(line, column, f"more than {MOST_VALUES} values in one file", allowed="ranges, samples and zips in place of long lists")
            return False
        bad = self.forbidden(event, kind, line, column)
        if kind in ("AliasEvent", "ScalarEvent"):
            value = BAD if bad else event.value
            is_key = bool(self.stack) and isinstance(self.stack[-1].value, dict) and self.pending[-1] is None
            if not bad and kind == "ScalarEvent":
                try:
                    value = joined(event.value)
                except ValueError as error:
                    self.report(line, column, f"{error}, which no file can hold as text", allowed="text without it")
                    bad, value = True, BAD
            if not bad and event.style is None and not is_key:
                try:
                    value = scalar(event.value)
                except ValueError as error:
                    self.report(line, column, f"{error}", given=brief(event.value), allowed="a finite number that fits, or text")
                    value = BAD
            self.add(Node(value, self.origin, line, column))
            return True
        if len(self.stack) >= MOST_DEPTH:
            self.report(line, column, f"more than {MOST_DEPTH} levels deep", allowed=f"at most {MOST_DEPTH} levels")
            return False
        node = Node({} if kind == "MappingStartEvent" else [], self.origin, line, column)
        self.under.append(self.here())
        self.add(node)
        self.stack.append(node)
        self.pending.append(None)
        return True

    def forbidden(self, event: Any, kind: str, line: int, column: int) -> bool:
        """Tags, anchors and aliases; True if the value cannot be used."""
        if kind == "AliasEvent":
            self.report(line, column, f"an alias, *{event.anchor}", allowed="plain values; write it out, or share by `extends: base.yaml`")
            return True
        if event.anchor is not None:
            self.report(line, column, f"an anchor, &{event.anchor}", allowed="plain values; write it out, or share by `extends: base.yaml`")
        if event.tag is not None:
            self.report(line, column, f"a tag, {brief(str(event.tag))}", allowed="plain values without tags")
        return event.tag is not None and kind == "ScalarEvent"


def read(text: str, origin: Origin) -> tuple[Node | None, list[Problem]]:
    """Nodes of a YAML 1.2 text, and what is wrong with it as YAML; None if it cannot be read at all."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError
    from ruamel.yaml.reader import ReaderError

    from mpm.config.tabs import TabScanner

    builder = Builder(origin)
    yaml = YAML(typ="safe", pure=True)
    yaml.Scanner = TabScanner
    try:
        for event in yaml.parse(text):
            if not builder.feed(event):
                return None, builder.problems
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
        said = " ".join(str(part) for part in (error.context, error.problem) if part)
        builder.report(min(line, max(1, len(origin.lines))), column, f"this is not YAML: {said}")
        return None, builder.problems
    except ReaderError as error:
        before, letter = text[: error.position], text[error.position]
        line, column = len(BREAK.findall(before)) + 1, len(BREAK.split(before)[-1]) + 1
        if "\ud800" <= letter <= "\udfff":  # of a command line
            builder.report(line, column, "this is not UTF-8 text", given=escaped(letter))
        else:
            said, wanted = f"this is not YAML: the control character U+{ord(letter):04X}", f'its escape, in double quotes: "{escaped(letter)}"'
            wanted = wanted if ord(letter) else "text without it"
            builder.report(line, column, said, allowed=wanted)
        return None, builder.problems
    except (YAMLError, ValueError, AssertionError, IndexError, KeyError, AttributeError, TypeError) as error:  # ruamel on odd characters and directives
        builder.report(1, 1, f"this is not YAML: {' '.join(str(error).split())[:200]}")
        return None, builder.problems
    return builder.root, builder.problems


def read_file(path: Path, shown: str) -> tuple[Node | None, list[Problem], str]:
    """Nodes, problems and text of a file; all that can go wrong with opening it is a problem too."""
    origin = Origin(shown)
    if path.is_fifo() and path.parts[:2] not in (("/", "dev"), ("/", "proc")):  # a shell's own pipes are there, and have a writer
        return None, [origin.problem(0, 0, "", "cannot read the file: it is a pipe, which may never end", allowed="a file")], ""
    try:
        with path.open("rb") as stream:
            raw = stream.read(MOST_BYTES + 1)
    except OSError as error:
        words = [item.name for item in path.parent.glob("*.y*ml")] if path.parent.is_dir() else []
        return None, [origin.problem(0, 0, "", f"cannot read the file: {error.strerror}", suggestion=near(path.name, words))], ""
    except ValueError as error:
        return None, [origin.problem(0, 0, "", f"cannot read the file: {error}")], ""
    if len(raw) > MOST_BYTES:
        return None, [origin.problem(0, 0, "", "the file is larger than 1 MiB", allowed="at most 1 MiB")], ""
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = raw[: error.start].decode("utf-8-sig", "replace")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        return None, [origin.problem(line, column, "", "this is not UTF-8 text", given=f"byte 0x{raw[error.start]:02x}")], ""
    node, problems = read(text, Origin(shown, lines(text)))
    return node, problems, text


def lines(text: str) -> tuple[str, ...]:
    """The lines of a YAML text, as its parser counts them."""
    return tuple(BREAK.split(text))


def wrap(value: Any, origin: Origin, problems: list[Problem], path: tuple = ()) -> Node:
    """Nodes of Python data: dicts with text keys, lists, tuples, numbers (numpy's too), text, booleans, None."""
    if len(path) > MOST_DEPTH:
        problems.append(origin.problem(0, 0, ".".join(map(str, path)), f"more than {MOST_DEPTH} levels deep", allowed=f"at most {MOST_DEPTH} levels"))
        return Node(BAD, origin)
    if hasattr(value, "tolist"):  # numpy numbers and arrays, without importing numpy
        value = value.tolist()
    if isinstance(value, dict):
        node = Node({}, origin)
        for key, item in value.items():
            if isinstance(key, str):
                if (name := letters(key, origin, problems, path)) is not BAD:
                    node.put(name, wrap(item, origin, problems, (*path, name)), (origin, 0, 0))
            else:
                problems.append(origin.problem(0, 0, ".".join(map(str, path)), "a key must be text", given=brief(key)))
        return node
    if isinstance(value, list | tuple):
        return Node([wrap(item, origin, problems, (*path, index)) for index, item in enumerate(value)], origin)
    if isinstance(value, str):
        return Node(letters(value, origin, problems, path), origin)
    if value is None or isinstance(value, bool | int | float):
        return Node(value, origin)
    said = f"a {type(value).__name__} cannot stand in a config"
    problems.append(origin.problem(0, 0, ".".join(map(str, path)), said, allowed="numbers, text, lists and mappings"))
    return Node(BAD, origin)


def letters(text: str, origin: Origin, problems: list[Problem], path: tuple) -> Any:
    """Text that files can hold; what cannot be is told, and BAD."""
    try:
        return joined(text)
    except ValueError as error:
        problems.append(origin.problem(0, 0, ".".join(map(str, path)), f"{error}, which no file can hold as text", allowed="text without it"))
        return BAD
