"""The command `mpm`: registers a file a command, and turns whatever happens into words and an exit code. No user sees a traceback.

Exit codes   0 ok; 1 internal error, disk (stdout's too), or (compare) different; 2 usage or config; 3 some points failed; 4 every point failed;
75, 130, 143 stopped; 141 all went well, and the reader of the output left
"""

import os
import sys
import warnings
from typing import Any

import typer
from mpm_cli.ask import ask
from mpm_cli.bench import bench
from mpm_cli.chart import chart
from mpm_cli.collect import collect
from mpm_cli.compare import compare
from mpm_cli.docs import docs
from mpm_cli.explain import explain
from mpm_cli.export import export
from mpm_cli.fit import fit
from mpm_cli.info import info
from mpm_cli.movie import movie
from mpm_cli.new import new
from mpm_cli.plan import plan
from mpm_cli.plot import plot
from mpm_cli.report import report
from mpm_cli.run import run
from mpm_cli.schema import schema
from mpm_cli.sensitivity import sensitivity
from mpm_cli.stability import stability
from mpm_cli.status import status
from mpm_cli.streams import streams
from mpm_cli.sweep import sweep
from mpm_cli.talk import internal, leave_at_once, warn
from mpm_cli.unseen import openssl, unseen
from mpm_cli.verify import verify
from mpm_cli.warmup import warmup

COMMANDS = (
    new,
    run,
    sweep,
    fit,
    sensitivity,
    ask,
    plan,
    chart,
    stability,
    status,
    collect,
    compare,
    verify,
    plot,
    movie,
    export,
    report,
    bench,
    explain,
    docs,
    schema,
    info,
    warmup,
)
UsageError: Any = typer.BadParameter.__mro__[1]  # typer brings its own copy of click from some version on

app = typer.Typer(
    name="mpm",
    help="Batch experiments in thermomechanical material point simulation.",
    add_completion=False,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in COMMANDS:
    app.command(command.__name__, context_settings={"ignore_unknown_options": command is explain})(command)  # explain --timeout


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    if "_MPM_COMPLETE" in os.environ:
        from typer.completion import completion_init

        completion_init()
    if not sys.warnoptions:
        warnings.simplefilter("ignore")  # what users should know has words of its own; `python -W` shows the rest
    words = sys.argv[1:] if arguments is None else arguments
    whole = arguments is not None or any(word.startswith("--scheduler") for word in words)  # somebody else's process, or one that speaks to a cluster
    hidden = () if whole else ("dask", "babel", *(openssl() if words[:1] == ["sweep"] else ()))
    with streams() as (out, err), unseen(*hidden):
        code = command_code(words)
        out.flush()
    return code or out.code or err.code


def command_code(arguments: list[str]) -> int:
    """The exit code of a command, without what becomes of its words."""
    try:
        return int(typer.main.get_command(app).main(arguments, prog_name="mpm", standalone_mode=False, obj=arguments) or 0)
    except UsageError as error:
        usage = error.ctx.get_usage() + "\n" if error.ctx and arguments else ""
        warn(f"{usage}error: {error.format_message()}" if usage else error.format_message())
        return 2
    except (KeyboardInterrupt, typer.Abort):
        leave_at_once()
        warn("stopped")
        return 130
    except Exception as error:
        return exit_code(error)


def exit_code(error: Exception) -> int:
    """An exception in words, and its exit code."""
    from mpm.sweep.executors import BrokenWorkers
    from mpm.sweep.store import Refused

    # named without importing what the command did not need
    places = [("mpm.config", "ConfigError"), ("mpm.plots", "UnknownFigure"), ("mpm.plots", "NoDataset"), ("mpm.scene.refusal", "SceneError")]
    places += [("mpm.opened", "UnknownPoint"), ("mpm.exports", "ExportError"), ("mpm.movies", "MovieError"), ("mpm.starting.places", "Missing")]
    ours = [getattr(sys.modules.get(room), name, None) for room, name in places]
    if isinstance(error, (Refused, *filter(None, ours))):
        warn(str(error))
        return 2
    if isinstance(error, MemoryError):
        warn("error: there is not enough memory; a coarser grid.cell, fewer particles a cell or fewer points need less")
        return 1
    if isinstance(error, BrokenWorkers):
        warn(f"error: {error}")
        return 1
    if isinstance(error, OSError) and error.filename is not None:
        warn(f"error: {error.filename}: {error.strerror}")
        return 1
    internal(error, "internal error")
    return 1
