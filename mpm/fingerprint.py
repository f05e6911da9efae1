"""Hashes of source: of a whole result, and of the rooms (folders and modules of this package) that a compiled kernel can contain.

A kernel can contain the functions of its own room and of the rooms below it. It is named in the compile cache after the hash of just those, so that an edit
of a guard, a plot or an observer compiles no step again. Rooms are hashed, not single modules: a law registers itself from a module that no kernel imports.
"""

import functools
import hashlib
import re
from pathlib import Path

NO_PART = {"cache", "compiling", "memory"}  # rooms that kernels' modules import, and that no kernel can contain
PACKAGE = Path(__file__).parent
BELOW = re.compile(r"^(?:from|import) mpm\.(\w+)|^from mpm import \(?([\w, ]+)", re.MULTILINE)  # imports at the top of a module: kernels see no others


def source_hash(without: frozenset | set = frozenset()) -> str:
    """Hash of every Python file of the package, less the rooms named (16 hex digits)."""
    return digest(files for room, files in rooms().items() if room not in without)


@functools.cache
def rooms() -> dict[str, dict[str, str]]:
    """Text of every Python file by place, by room."""
    found: dict[str, dict[str, str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        place = path.relative_to(PACKAGE)
        found.setdefault(place.parts[0].removesuffix(".py"), {})[place.as_posix()] = path.read_text(encoding="utf-8")
    return found


def digest(parts) -> str:
    """Hash of files (16 hex digits): dictionaries of their text by place."""
    made = hashlib.sha256()
    for files in parts:
        for place, text in files.items():
            made.update(f"{place}\0{text}\0".encode())
    return made.hexdigest()[:16]


@functools.cache
def of_room(room: str) -> str:
    """Hash of the files of one room."""
    return digest([rooms()[room]])


def hash_of(names) -> str:
    """Hash of all files of the rooms named."""
    return digest([{name: of_room(name) for name in names}])


@functools.cache
def imported(room: str) -> set[str]:
    """Rooms that the modules of a room import at their tops, but those that are no part of a kernel."""
    pairs = [pair for text in rooms()[room].values() for pair in BELOW.findall(text)]
    return {name.strip() for pair in pairs for name in (pair[0] or pair[1]).split(",")} & set(rooms()) - NO_PART


@functools.cache
def contained(room: str) -> frozenset[str]:
    """The room and all rooms that its modules import, directly or through others."""
    found, waiting = set(), {room}
    while waiting:
        one = waiting.pop()
        found.add(one)
        waiting |= imported(one) - found
    return frozenset(found)


@functools.cache
def fingerprint(module: str) -> str:
    """`<room>-<hash>` of what kernels of a module can contain; of the whole package for a module elsewhere (a test's own kernels)."""
    top, _, rest = module.partition(".")
    room = rest.partition(".")[0]
    if top != "mpm" or room not in rooms():
        return f"other-{source_hash()}"
    return f"{room}-{hash_of(sorted(contained(room)))}"
