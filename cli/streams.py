"""stdout and stderr as commands write to them. Whatever becomes of them, the work goes on: a reader that leaves, a full disk, a terminal that is gone.

What could not be written is lost; main tells by its exit code. Letters that the encoding does not have become escapes. A stream that was closed before the
command began is os.devnull, and so is its descriptor, which the next file to be opened would get otherwise, with all that a library writes to it.
"""

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from typing import Any

BROKEN_PIPE, LOST = 141, 1  # exit codes of a command that went well, where nobody heard of it


class Stream:
    """A text stream whose writes never fail; `error` is the first that would have."""

    def __init__(self, stream: Any, name: str):
        self.stream = stream if stream is not None else open(os.devnull, "w", encoding="utf-8")
        self.name = name
        self.error: OSError | None = None

    def write(self, text: str) -> int:
        """Write, or lose, a text."""
        try:
            return self.stream.write(text)
        except UnicodeEncodeError:
            return self.write(text.encode(self.stream.encoding, "backslashreplace").decode(self.stream.encoding))
        except OSError as error:
            self.lose(error)
        return len(text)

    def flush(self) -> None:
        """Write what is buffered, or lose it."""
        try:
            self.stream.flush()
        except OSError as error:
            self.lose(error)

    def lose(self, error: OSError) -> None:
        """From now on nothing is written; told once, on stderr, unless it is a reader who wanted no more."""
        with contextlib.suppress(OSError, ValueError):  # no descriptor of its own, as in a notebook
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, self.stream.fileno())
            os.close(null)
        if self.error is None:
            self.error = error
            if error.errno != errno.EPIPE and self.name == "stdout":
                sys.stderr.write(f"error: stdout: {error.strerror}; the work goes on, and what it says is lost\n")

    @property
    def code(self) -> int:
        """The exit code that tells what was lost."""
        return 0 if self.error is None else BROKEN_PIPE if self.error.errno == errno.EPIPE else LOST

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextlib.contextmanager
def streams() -> Iterator[tuple[Stream, Stream]]:
    """stdout and stderr of this process as Streams while this lasts."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest that is free, which is this one
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = Stream(before[0], "stdout"), Stream(before[1], "stderr")
    try:
        yield sys.stdout, sys.stderr
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        sys.stdout, sys.stderr = before
