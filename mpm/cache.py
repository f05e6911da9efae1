"""Where compiled code is kept between runs: a folder that only this user can write to.

To load compiled code is to run it: whoever can write there runs code as this user. So a folder that belongs to somebody else, that others can enter, or that
is a link is not looked into; one beside it is made, and that is said. Imports nothing heavy: a sweep's own process finds the place for its workers.
"""

import atexit
import contextlib
import functools
import os
import platform
import shutil
import stat
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

VARIABLE = "MPM_CACHE_DIR"
TRIES = 10
words: list[str] = []  # what was said of it in this process
made: list[tuple[int, Path]] = []  # temporary places, and the process that made them


def base() -> Path:
    """`$MPM_CACHE_DIR`, else the user's cache folder; where that cannot be used, a temporary one for this process and those that it starts."""
    given = os.environ.get(VARIABLE)
    folder = Path(given or Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser(), "mpm"))
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not given and folder.stat().st_uid == os.geteuid():
            folder.chmod(folder.stat().st_mode & ~0o022)  # made under another umask
        with tempfile.TemporaryFile(dir=folder):
            why = exchangeable(folder)
    except OSError as error:
        why = error.strerror or str(error)
    if not why:
        return folder
    place = Path(tempfile.mkdtemp(prefix="mpm-cache-"))
    made.append((os.getpid(), place))
    os.environ[VARIABLE] = str(place)
    say(f"compiled code is not kept in {folder} ({why}): it is made anew, and kept until this command ends")
    return place


def private(name: str) -> Path:
    """The folder `name` in `base()`, or beside it where what has that name is not this user's alone."""
    above = base()
    for number in range(1, TRIES):
        folder = above / (f"{name}-{number}" if number > 1 else name)
        folder.mkdir(mode=0o700, exist_ok=True)
        if not (why := shared(folder)):
            return folder
        say(f"compiled code in {folder} is not used: {why}; it is made anew beside it")
    raise OSError(f"{above} holds {TRIES - 1} folders {name} that are not this user's alone; remove them, or name another place in {VARIABLE}")


@functools.cache
def kernels() -> Path:
    """The folder of the kernels that this Numba compiles for this NumPy, Python and processor."""
    return private(f"numba-{version('numba')}-{version('numpy')}-{platform.python_version()}-{platform.machine()}")


def shared(folder: Path) -> str:
    """Why what is in a folder may be somebody else's; empty where it is this user's alone."""
    found = os.lstat(folder)
    if not stat.S_ISDIR(found.st_mode):
        return "it is a link"
    if found.st_uid != os.geteuid():
        return f"it belongs to user {found.st_uid}"
    return f"others can enter it (mode {stat.S_IMODE(found.st_mode):04o} in place of 0700)" if found.st_mode & 0o077 else ""


def exchangeable(folder: Path) -> str:
    """Why somebody else could put another folder in the place of one that lies here; empty where nobody can."""
    found = folder.stat()
    if found.st_uid not in (os.geteuid(), 0):
        return f"it belongs to user {found.st_uid}"
    return f"others can write there (mode {stat.S_IMODE(found.st_mode):04o})" if found.st_mode & 0o022 and not found.st_mode & stat.S_ISVTX else ""


def say(text: str) -> None:
    """Once, on stderr; a worker's parent tells it too, as nobody sees a worker's own words."""
    if text not in words:
        words.append(text)
        with contextlib.suppress(OSError, ValueError, AttributeError):
            sys.stderr.write(f"mpm: {text}\n")


@atexit.register
def remove() -> None:
    """Nothing temporary stays when the process that made it ends (and not when a fork of it does)."""
    while made:
        process, place = made.pop()
        if process == os.getpid():
            shutil.rmtree(place, ignore_errors=True)
