"""mpm warmup: compile now, so that the first run does not."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.talk import say


def warmup(configs: Annotated[list[Path], typer.Argument(metavar="CONFIG...", help="Configs whose kernels are compiled.", show_default=False)]) -> None:
    """Compile now what configs need."""
    import time

    from mpm.runner import warm

    from mpm.config import load

    experiments = [(config, load(config)) for config in configs]
    for config, experiment in experiments:
        began = time.monotonic()
        warm(experiment)
        say(f"{config}: {time.monotonic() - began:.1f} s")
