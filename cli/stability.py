"""mpm stability: where a method fails, mapped over two axes, beside the theory's line."""

from typing import Any

import typer
from mpm_cli.options import Config, Jobs, Json, Out, Quiet, Set, Smoke, again, load
from mpm_cli.progress import Bar, reporter
from mpm_cli.talk import document, internal, say, warn


def stability(
    context: typer.Context,
    config: Config,
    out: Out = None,
    jobs: Jobs = "auto",
    set_: Set = None,
    smoke: Smoke = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Map where a method fails, past its limits.

    The config's `stability:` section names two axes, panels (methods) and lines of theory. The boundary along the vertical axis is bracketed and then
    refined, in rounds of an ordinary sweep. OUT/sweep.nc holds every point, OUT/stability.nc the boundaries, OUT/stability.png the map. Repeat the
    command to continue. Exit codes: 0 the map is complete (its points may fail); 2 usage or config; 75, 130, 143 stopped.
    """
    from mpm.study.boundary import sentences
    from mpm.study.stability import run
    from mpm.sweep.api import default_out
    from mpm.sweep.engine import Options

    experiment = load(config, set_, smoke)
    folder = out or default_out(experiment)
    done = run(experiment, folder, Options(jobs, smoke=smoke), calm(reporter(as_json, quiet)), lambda text: say(text, quiet=quiet or as_json))
    if done.dataset is None:
        warn(f"stopped ({done.result.stopped}); to go on: {again(context)}")
        raise typer.Exit(done.result.exit_code)
    picture, said = draw(done.dataset), sentences(done.map)
    if as_json:
        points = sum(len(column.verdicts) for column in done.map.columns)
        document({"out": folder, "dataset": done.dataset, "picture": picture, "points": points, "ran": done.ran, "sentences": said})
        return
    for line in (*said, str(done.dataset), *([str(picture)] if picture else [])):
        say(line, quiet=quiet)


def calm(talks: Any) -> Any:
    """A reporter that does not tell each point: on a map, failing is what points are for. A bar stays; notes are told."""
    from mpm.sweep.report import Reporter

    if isinstance(talks, Bar):
        tell, talks.finished = talks.finished, lambda label, line, again: tell(label, {**line, "status": 0}, again)
        return talks

    class Notes(Reporter):
        def note(self, text: str) -> None:
            talks.note(text)

    return Notes()


def draw(dataset: Any) -> Any:
    """OUT/stability.png."""
    from mpm.plots.stability import draw as figure
    from mpm.plots.style import save
    from mpm.sweep.api import tree_of

    try:
        return save(figure(tree_of(dataset)), dataset.with_suffix(".png"))
    except Exception as error:  # the map is there and sound; a figure that fails is told, and does not hide it
        internal(error, "the figure failed")
        return None
