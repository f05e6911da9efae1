"""mpm fit: parameters from measured curves."""

from typing import Annotated, Any

import typer
from mpm_cli.options import Config, Jobs, Json, Out, Quiet, Set, Smoke, again, limit, load
from mpm_cli.progress import reporter
from mpm_cli.stability import calm
from mpm_cli.sweep import RESULTS, SCHEDULER, Rerun, address, route
from mpm_cli.talk import document, internal, leave_at_once, say, warn

HOLD = "Predict this measured curve instead of fitting to it, and tell its error; repeat for more."
POSTERIOR = "Also sample the posterior with so many steps of emcee (pip install 'mpm[posterior]')."


def fit(
    context: typer.Context,
    config: Config,
    out: Out = None,
    jobs: Jobs = "auto",
    set_: Set = None,
    rerun: Rerun = None,
    hold_out: Annotated[list[str] | None, typer.Option("--hold-out", metavar="CURVE", help=HOLD, show_default=False)] = None,
    posterior: Annotated[int, typer.Option("--posterior", metavar="STEPS", min=0, help=POSTERIOR)] = 0,
    timeout: Annotated[float | None, limit("Time limit per point, e.g. 90, 90s, 5min or 2h.")] = None,
    time_budget: Annotated[float | None, limit("Stop after this time; the same command continues.")] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", parser=address, help=SCHEDULER, show_default=False)] = None,
    results: Annotated[str, typer.Option(metavar="wire|shared", parser=route, help=RESULTS)] = "wire",
    smoke: Smoke = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find parameters from measured curves, with intervals, and tell what the data cannot tell apart.

    The config's `fit:` section names parameters with their ranges, `output.measured` the curves. Every evaluation is a point of an ordinary sweep in OUT;
    repeat the command to continue a stopped fit. OUT/fit.nc holds the answer, OUT/fit.png the picture, OUT/sweep.nc every point tried.
    Exit codes: 0 ok; 2 usage or config; 3 some points failed or the search did not converge; 4 no point could be computed; 75 time budget reached;
    130 Ctrl-C; 143 SIGTERM.
    """
    from mpm.fit.api import run
    from mpm.fit.least import NoFit
    from mpm.fit.sentences import sentences
    from mpm.sweep.api import default_out
    from mpm.sweep.engine import Options
    from mpm.sweep.rounds import Stopped

    experiment = load(config, set_, smoke)
    folder = out or default_out(experiment)
    options = Options(jobs, timeout, time_budget=time_budget, rerun=rerun, smoke=smoke, scheduler=scheduler, shared=results == "shared")
    talk = lambda text: say(text, as_json, quiet)  # noqa: E731
    try:
        done = run(experiment, folder, options, calm(reporter(as_json, quiet)), tuple(hold_out or ()), posterior, talk)
    except Stopped as stopped:
        leave_at_once()
        if as_json:
            document({"out": folder, "stopped": stopped.why, "exit_code": stopped.code})
        warn(f"stopped ({stopped}); to go on: {again(context)}")
        raise typer.Exit(stopped.code) from None
    except NoFit as error:
        if as_json:
            document({"out": folder, "error": str(error), "exit_code": 4})
        warn(f"error: {error}")
        raise typer.Exit(4) from None
    picture, said = draw(done.dataset), sentences(done)
    if as_json:
        document(summary(done, folder, picture, said))
    else:
        for line in (*said, f"{len(done.evaluator.known)} points, {done.ran} run now", str(done.dataset), *([str(picture)] if picture else [])):
            say(line, quiet=quiet)
    raise typer.Exit(done.exit_code)


def summary(done: Any, folder: Any, picture: Any, said: list[str]) -> dict[str, Any]:
    """The JSON document."""
    from mpm.fit.sentences import limits

    known = done.known
    parameters = {
        p.name: {"best": known.values[k], "standard_error": known.error[k], "interval": limits(done, k)[:2], "units": p.units, "config_path": p.path}
        for k, p in enumerate(done.problem.parameters)
    }
    apart = [{"parameters": [done.problem.names[pair.i], done.problem.names[pair.j]], "correlation": pair.correlation, "power": pair.power,
              "fixed": pair.value, "error": pair.error} for pair in done.pairs]  # fmt: skip
    failures = [{"point": list(key), "error": why} for key, why in done.evaluator.failed.items()]
    return {"out": folder, "dataset": done.dataset, "picture": picture, "parameters": parameters, "correlation": known.correlation,
            "cannot_be_told_apart": apart, "points": len(done.evaluator.known), "ran": done.ran, "failures": failures,
            "converged": done.converged, "sentences": said, "exit_code": done.exit_code}  # fmt: skip


def draw(dataset: Any) -> Any:
    """OUT/fit.png."""
    from mpm.plots.fit import draw as figure
    from mpm.plots.style import save
    from mpm.sweep.api import tree_of

    try:
        return save(figure(tree_of(dataset)), dataset.with_suffix(".png"))
    except Exception as error:  # the fit is there and sound; a figure that fails is told, and does not hide it
        internal(error, "the figure failed")
        return None
