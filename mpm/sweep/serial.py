"""Serial: an Executor whose points run one after another in this process."""

from collections.abc import Callable

from mpm.sweep.executors import Beat, Event, Note, Task, event
from mpm.sweep.worker import perform


class Serial:
    """Points one after another in this process: for a debugger, for coverage, for tests. A crash takes the sweep with it.

    `heed(event)` sees every beat, as `poll` does not return while a point runs; it may call `cancel`.
    """

    def __init__(self, runner: str, heed: Callable[[Beat], None]):
        self.runner = runner
        self.heed = heed
        self.wanted = 1
        self.task: Task | None = None
        self.stop = ""

    @property
    def free(self) -> int:
        """1 when nothing waits."""
        return int(self.task is None)

    def submit(self, task: Task) -> None:
        """Take a task; it runs in `poll`."""
        self.task, self.stop = task, ""

    def poll(self, timeout: float) -> list[Event]:
        """Run the task that waits."""
        if self.task is None:
            return []
        task = self.task

        def beat(run_id: str, fraction: float, time: float) -> str:
            self.heed(Beat(task.id, run_id, fraction, time))
            return self.stop

        notes: list[Event] = []
        message = perform(task, self.runner, beat, note=lambda text: notes.append(Note(text)))
        self.task = None
        return [*notes, event(message)]

    def cancel(self, task: str, why: str) -> None:
        """Stop the running task at its next beat."""
        if self.task is not None and self.task.id == task:
            self.stop = why

    def kill(self, task: str, why: str) -> None:
        """As `cancel`: there is no other process to end."""
        self.cancel(task, "cancel")

    def close(self) -> None:
        """Nothing to end."""
