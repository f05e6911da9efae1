"""mpm warmup: compile now, so that the first run does not."""

from pathlib import Path
from typing import Annotated

import typer
from mpm_cli.talk import say

Configs = Annotated[list[Path] | None, typer.Argument(metavar="[CONFIG...]", help="What to compile for.  [default: the usual scenes]", show_default=False)]


def warmup(configs: Configs = None) -> None:
    """Compile now what configs need, so that their first run does not wait. A folder stands for all configs in it."""
    import importlib
    import time

    from mpm.config import load
    from mpm.sweep import engine
    from mpm.sweep.warming import scenes

    configs = [path for place in configs or () for path in (sorted(place.glob("*.yaml")) if place.is_dir() else [place])]
    experiments = {str(config): load(config) for config in configs} if configs else {name: load(scene) for name, scene in scenes().items()}
    runner = importlib.import_module(engine.RUNNER)
    for name, experiment in experiments.items():
        began = time.monotonic()
        runner.warm(experiment)
        say(f"{name}: {time.monotonic() - began:.1f} s")
