"""One process in a sweep's folder: it takes the folder, reads what is there, and hears signals meanwhile."""

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator
from typing import Any

from mpm.sweep.lock import Lock, Refused, said_owner
from mpm.sweep.queue import Points
from mpm.sweep.store import Store
from mpm.sweep.summaries import Summaries

STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextlib.contextmanager
def taken(store: Store, note: Callable[[str], None], **more: Any) -> Iterator[None]:
    """A folder, made where it is missing, that this process alone writes in while this lasts."""
    try:
        store.out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise Refused(f"{store.out} is no folder; choose another place with --out") from None
    with Lock(store.out, **more) as lock:
        if lock.dead is not None:
            left = store.tidy()
            note(f"{said_owner(lock.dead)} ended without leaving; its lock is cleared" + (f", {left} half-written files are removed" if left else ""))
        yield


def sound(store: Store, points: Points, note: Callable[[str], None]) -> Summaries:
    """Summaries of the points that are there; files that are not as they were written are set aside."""
    lines, damaged = store.lines(points.ids)
    for name in damaged:
        note(f"{store.set_aside(name)}: the file was damaged, or held another point, and is set aside; its point runs again")
    return lines


@contextlib.contextmanager
def signals(heard: Callable[[str], None]) -> Iterator[None]:
    """Ctrl-C, SIGTERM and SIGHUP (which is as SIGTERM, unless it is ignored, as under nohup) go to `heard` while this lasts.

    Elsewhere than in the main thread nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: handler for number in STOPS if (handler := signal.getsignal(number)) != signal.SIG_IGN}
    for number in before:
        signal.signal(number, lambda got, _: heard("interrupted" if got == signal.SIGINT else "terminated"))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
