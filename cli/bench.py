"""mpm bench: throughput on this machine."""

import json
from pathlib import Path
from typing import Annotated, Literal

import typer
from mpm_cli.options import Json, Set, Threads, load
from mpm_cli.talk import document, say, warn

Config = Annotated[
    Path | None, typer.Argument(metavar="[CONFIG]", help="YAML file of an experiment. Without it, a cube that is thrown through a box.", show_default=False)
]


def bench(
    config: Config = None,
    n: Annotated[int, typer.Option("--n", min=12, help="Cells along each side of the unit box.")] = 64,
    particles: Annotated[int, typer.Option("--np", min=1, help="Approximate number of particles.")] = 100_000,
    ppc: Annotated[int, typer.Option("--ppc", min=0, help="Particles per cell; 0 means 8 in three dimensions and 4 in two.")] = 0,
    dim: Annotated[int, typer.Option("--dim", min=2, max=3, help="Number of dimensions.")] = 3,
    dtype: Annotated[Literal["f32", "f64"], typer.Option("--dtype", help="Precision.")] = "f32",
    threads: Threads = 1,
    warm: Annotated[int, typer.Option("--warm", min=1, help="Steps before timing starts.")] = 10,
    steps: Annotated[int, typer.Option("--steps", min=1, help="Steps in each timed block.")] = 10,
    reps: Annotated[int, typer.Option("--reps", min=1, help="Number of timed blocks.")] = 9,
    order: Annotated[Literal["lattice", "shuffle"], typer.Option("--order", help="Initial order of the particles in memory.")] = "lattice",
    compare: Annotated[
        str | None,
        typer.Option("--compare", metavar="REV", help="Time a revision of mpm (commit, tag, branch) beside this checkout.", show_default=False),
    ] = None,
    rounds: Annotated[int, typer.Option("--rounds", min=1, help="Rounds of --compare.")] = 5,
    only: Annotated[str, typer.Option("--only", metavar="TEXT", help="With --compare, only scenes whose name has TEXT in it.")] = "",
    set_: Set = None,
    as_json: Json = False,
) -> None:
    """Measure throughput on this machine: of the scene on which other codes are timed, or of a config, by phase and by physics.

    Without CONFIG it prints one JSON line, with the same fields as the timing programs of other codes. To compare codes, alternate whole runs on one core
    of an idle machine, use three rounds or more, take ratios of medians, and check first that `check` agrees.
    --compare REV does so for another revision of mpm: ten scenes in turn, and the range of their ratios.
    """
    if compare is not None:
        return in_turn(compare, rounds, only, as_json)
    if config is None:
        from mpm.integrate.sorting import SHARED
        from mpm.study.bench import BenchError, Options, bench

        try:
            found = bench(Options(n, particles, ppc, dim, dtype, warm, steps, reps, order, threads))
        except BenchError as error:
            warn(str(error))
            raise typer.Exit(2) from None
        from importlib.metadata import version

        given = {"peer": "mpm", "version": version("mpm"), "dim": dim, "n": n, "ppc": ppc or {2: 4, 3: 8}[dim], "dtype": dtype, "order": order}
        if found["threads"] < threads:
            warn(f"one thread did all: more help from {SHARED} particles on")
        print(json.dumps(given | found), flush=True)
        return
    from mpm.study.phases import phases, table

    found = phases(load(config, set_), threads)
    if as_json:
        document(found)
    else:
        say(table(found))


def in_turn(revision: str, rounds: int, only: str, as_json: bool) -> None:
    """Another revision of the checkout timed beside this one, in turn; exit code 2 where it cannot be."""
    from mpm.study.bench import BenchError
    from mpm.study.watch import HEAD, line
    from mpm.study.watch import compare as compared

    rows = []
    try:
        for row in compared(revision, rounds, only):
            rows.append(row)
            if not as_json:
                say(line(row) if len(rows) > 1 else f"{HEAD}\n{line(row)}")
    except BenchError as error:
        warn(str(error))
        raise typer.Exit(2) from None
    if as_json:
        document(rows)
