"""Lock: one writer a folder, held with flock in OUT/lock: the kernel releases it when its owner dies. The file says who holds it."""

import contextlib
import errno
import fcntl
import json
import os
import platform
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from mpm.records.provenance import now

UNWRITABLE = (errno.EROFS, errno.EACCES, errno.EPERM)
TRIES, WAIT = 10, 0.02  # somebody who only looks (`owner`) holds it for microseconds


class Refused(Exception):
    """The folder cannot be used as asked; the text says why and what can be done."""


class Lock:
    """`with Lock(folder) as lock:` one writer a folder. A dead owner cannot hold it: `lock.dead` is who died without leaving, or None."""

    def __init__(self, folder: Path, **more: Any):
        self.path, self.more = Path(folder) / "lock", more
        self.descriptor = -1
        self.dead: dict | None = None

    def __enter__(self) -> "Lock":
        try:
            descriptor = os.open(self.path, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            if error.errno not in UNWRITABLE:
                raise
            raise OSError(error.errno, f"{error.strerror}; choose another folder with --out", str(self.path.parent)) from None
        for left in reversed(range(TRIES)):
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if left and not os.fstat(descriptor).st_size:
                    time.sleep(WAIT)
                    continue
                os.close(descriptor)
                who = said_owner(owner(self.path.parent))
                raise Refused(f"{self.path.parent} is in use by {who}; wait for it, or choose another folder with --out") from None
        self.descriptor, self.dead = descriptor, said_by(descriptor)
        text = json.dumps({"pid": os.getpid(), "host": platform.node(), "since": now(), **self.more}).encode()
        try:
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, text, 0)
        except OSError as error:
            os.close(descriptor)
            raise OSError(error.errno, f"cannot write {len(text)} bytes: {error.strerror}", str(self.path)) from error
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError):  # the disk may fail by now: the next then hears of an owner that died, which does no harm
            os.ftruncate(self.descriptor, 0)
        os.close(self.descriptor)


@contextlib.contextmanager
def lock_where_possible(folder: Path, **more: Any) -> Iterator[bool]:
    """The lock of a folder while this lasts; False where nothing can be written there, and nobody is at work."""
    lock = Lock(folder, **more)
    try:
        lock.__enter__()
    except OSError as error:
        if error.errno not in UNWRITABLE:
            raise
        if (who := owner(folder)) is not None:
            raise Refused(f"{folder} is in use by {said_owner(who)}; wait for it") from None
        yield False
        return
    try:
        yield True
    finally:
        lock.__exit__()


def said_by(descriptor: int) -> dict | None:
    """What the file says of its owner; None where it says nothing, {} where that cannot be read."""
    try:
        found = json.loads(text) if (text := os.pread(descriptor, 4096, 0)) else None
    except ValueError:
        return {}
    return found if isinstance(found, dict) and {"pid", "host", "since"} <= found.keys() else None if found is None else {}


def owner(folder: Path) -> dict | None:
    """Who sweeps in a folder now: {pid, host, since, ...}; None for nobody, {} where it does not say."""
    try:
        descriptor = os.open(Path(folder) / "lock", os.O_RDONLY)
    except FileNotFoundError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return None
    except BlockingIOError:
        return said_by(descriptor) or {}
    finally:
        os.close(descriptor)


def said_owner(found: dict | None) -> str:
    """The owner in words."""
    return f"process {found['pid']} on {found['host']} since {found['since']}" if found else "another process"
