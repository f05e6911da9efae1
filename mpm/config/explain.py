"""From what pydantic found and from findings of our own checks to problems with file, line, column, alternatives and a suggestion."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError

from mpm.config.nodes import BAD, Node
from mpm.config.problems import MOST_FINDINGS, Problem, brief, listed, near
from mpm.config.schema_paths import Path, Slot

EXPECTED = {
    "model_type": "a mapping",
    "dict_type": "a mapping",
    "tuple_type": "a list",
    "string_type": "text",
    "list_type": "a list",
    "bool_type": "true or false",
}


LONGEST = 200  # letters of a key that are told


@dataclass(frozen=True)
class Finding:
    """Something wrong at a path of the data. `on_key` points at the key rather than at the value."""

    path: Path
    message: str
    allowed: Any = ""
    suggestion: str = ""
    on_key: bool = False
    missing: bool = False  # something is not there, which a base file might have
    given: Any = BAD  # BAD: show nothing


def shown(path: Path) -> str:
    """A path as users write it."""
    words = map(str, path)
    return ".".join(word if len(word) <= LONGEST else f"{word[:40]}..." for word in words)


def locate(root: Node, path: Path, on_key: bool) -> tuple[Node, tuple[Any, int, int], bool]:
    """The deepest node on a path, where to point, and whether a value on the way is already reported."""
    node, place = root, (root.origin, root.line, root.column)
    for index, key in enumerate(path):
        if node.value is BAD:
            return node, place, True
        child = node.child(key)
        if child is None:
            break
        last = index == len(path) - 1
        place = node.keys[key] if last and on_key and key in node.keys else (child.origin, child.line, child.column)
        if not last and key in node.keys and path[index + 1 :] and child.child(path[index + 1]) is None:
            place = node.keys[key]  # the next key is absent: point at the key of the mapping that lacks it
        node = child
    return node, place, node.value is BAD


def problem(root: Node, finding: Finding) -> Problem | None:
    """A finding with its place; None if the place is already reported as bad."""
    _, (origin, line, column), known = locate(root, finding.path, finding.on_key)
    if known:
        return None
    given = "" if finding.given is BAD else brief(finding.given)
    return origin.problem(line, column, shown(finding.path), finding.message, given=given, allowed=listed(finding.allowed), suggestion=finding.suggestion)


def problems(root: Node, findings: Iterable[Finding]) -> list[Problem]:
    """All findings with their places."""
    return [one for finding in findings if (one := problem(root, finding)) is not None]


def findings(error: ValidationError, slot: Slot, prefix: Path = ()) -> list[Finding]:
    """What pydantic says, in the words of a user of configs. `slot` is what was validated, at `prefix` of the data."""
    return [finding(item, slot, prefix) for item in error.errors(include_url=False)[:MOST_FINDINGS]]


def finding(item: Any, slot: Slot, prefix: Path) -> Finding:
    """One error of pydantic."""
    location, kind, given = tuple(item["loc"]), item["type"], item["input"]
    if "constant" in location:  # {constant: v} is a number, not a mapping
        location = location[: location.index("constant") + 1]
    path = (*prefix, *location)
    here = slot.walk(location)
    if kind == "missing":
        wanted = here.quantity.wanted if here and here.quantity else listed(here.keys) if here and here.keys else (here.description if here else "")
        return Finding(path, f"{location[-1]!r} is missing", wanted, on_key=True, missing=True)
    if kind == "extra_forbidden":
        parent = slot.walk(location[:-1])
        keys = parent.keys if parent else []
        return Finding(path, f"unknown key {str(location[-1])[:60]!r}", keys or "no keys", near(location[-1], keys), on_key=True)
    if kind in EXPECTED:
        keys = here.keys if here else []
        return Finding(path, f"expected {EXPECTED[kind]}{' with the keys ' + listed(keys) if keys else ''}", "", given=given)
    if kind == "too_short":
        least = item["ctx"]["min_length"]
        return Finding(
            path, f"at least {least} {'entry is' if least == 1 else 'entries are'} needed, found {item['ctx']['actual_length']}", "", on_key=not given
        )
    if kind == "too_long":
        return Finding(path, f"{len(given)} entries", f"at most {item['ctx']['max_length']}", on_key=True)
    if kind == "string_pattern_mismatch":
        return Finding(path, "not a plain name", "letters, digits and underscores, not beginning with a digit", given=given)
    context = item.get("ctx", {})
    if "message" in context:
        at, allowed = tuple(context["at"]), context["allowed"]
        words = allowed if isinstance(allowed, list) else []
        word = at[0] if kind == "kind" and at else given
        suggestion = context["suggestion"] or near(word, words)
        silent = at or kind in ("unit", "pair", "exchange")  # the message itself says what was given
        named = bool(at) and kind in ("kind", "kinds", "axis") and not isinstance(at[-1], int)
        return Finding((*path, *at), context["message"], allowed, suggestion, on_key=named, given=BAD if silent else given)
    return Finding(path, item["msg"][:1].lower() + item["msg"][1:], "", given=given)
