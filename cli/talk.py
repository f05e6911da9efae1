"""Talk: where words and documents go. With --json stdout holds one JSON document and nothing else; talk goes to stderr."""

import json
import math
import os
import signal
import sys
import tempfile
import threading
import traceback
from typing import Any

from mpm.text import visible


def strict(value: Any) -> Any:
    """A document that any JSON reader takes: infinities and NaN as text, numpy numbers as numbers, paths as text."""
    if isinstance(value, dict):
        return {str(key): strict(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [strict(inner) for inner in value]
    if hasattr(value, "tolist"):
        return strict(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value if isinstance(value, str | int | float | bool) or value is None else str(value)


def document(value: Any) -> None:
    """The JSON document of a command; letters that stdout does not have as JSON's own escapes."""
    text = json.dumps(strict(value), indent=1, ensure_ascii=False)
    try:
        text.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except UnicodeEncodeError:
        text = json.dumps(strict(value), indent=1)
    sys.stdout.write(text + "\n")


def shown(text: str) -> str:
    """Text of ours with what users wrote in it, as a terminal may show it: several lines, and no control characters but tabs before carets."""
    return visible(text, keep="\n\t")


def say(text: str, as_json: bool = False, quiet: bool = False) -> None:
    """A line for people."""
    if not quiet:
        (sys.stderr if as_json else sys.stdout).write(shown(text) + "\n")


def warn(text: str) -> None:
    """A line that is told always, on stderr."""
    sys.stderr.write(shown(text) + "\n")


def internal(error: Exception, what: str) -> None:
    """Our own fault: one line here, the trace (without values) in a file."""
    said = f"{what}: {type(error).__name__}: {error}"
    try:
        with tempfile.NamedTemporaryFile("w", prefix="mpm-error-", suffix=".txt", delete=False, encoding="utf-8", errors="backslashreplace") as file:
            traceback.print_exception(error, file=file)
    except OSError as full:
        warn(f"{said}\nno trace of it could be written ({full.strerror}); please report it with the output of `mpm info`")
        return
    warn(f"{said}\nwhere: {file.name}; please report it with that file and the output of `mpm info`")


def end(code: int) -> None:
    """End here and now."""
    from mpm import cache

    cache.remove()
    os._exit(code)


def leave_at_once() -> None:
    """The command was told to stop and has done what it had to: whoever tells it again finds it gone, without a word from an interpreter that is ending."""
    if threading.current_thread() is threading.main_thread():
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 143)):
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, lambda *_, code=code: end(code))
