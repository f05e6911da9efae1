"""fit: search, identify, profile, and write OUT/fit.nc. `mpm.fit(experiment, out=...)` and `mpm fit` come through here.

OUT/sweep.nc   every point that was tried, an ordinary dataset along `point`; OUT/fit.nc: see `write`
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mpm.fit.evaluate import Evaluator
from mpm.fit.identify import Known, gains, identify, pairs
from mpm.fit.least import Searches, search
from mpm.fit.problem import Problem, bare, read
from mpm.fit.profile import Side, profile
from mpm.sweep.api import default_out, tree_of
from mpm.sweep.engine import Options
from mpm.sweep.report import Reporter
from mpm.sweep.rounds import Rounds, Stopped


@dataclass
class Fitted:
    """A fit that is done. `chain`: draws of the posterior in SI, shape (draw, parameter)."""

    problem: Problem
    evaluator: Evaluator
    searches: Searches
    known: Known
    sides: list[Side]
    pairs: list[Any]
    gains: dict[str, Any]
    chain: Any = None
    ran: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    dataset: Path | None = None
    compiling: float = 0.0

    @property
    def converged(self) -> bool:
        """Whether the search came to its end, and not short of the optimum, as where failed points stand in its way."""
        return self.searches.best.converged and not self.known.short()

    @property
    def exit_code(self) -> int:
        """As of a sweep; 3 also where the search did not converge."""
        return 3 if self.evaluator.failed or not self.converged else 0


def solve(problem: Problem, run: Callable[[list], list], posterior: int = 0, told: Callable[[str], None] = lambda _: None) -> Fitted:
    """The whole fit, wherever points come from."""
    evaluator = Evaluator(problem, run)
    searches = search(evaluator, told)
    known = identify(evaluator, searches.best.u)
    sides = profile(evaluator, known) if known.variance > 0 else []
    if sides:
        told(f"intervals by profiles: {sum(len(side.places) for side in sides)} places")
    chain = None
    if posterior:
        from mpm.fit.posterior import sample

        chain = sample(evaluator, known, posterior, told)
    return Fitted(problem, evaluator, searches, known, sides, pairs(known), gains(evaluator, known), chain)


def run(
    experiment: Any,
    out: Path | None = None,
    options: Options | None = None,
    reporter: Reporter | None = None,
    hold_out: tuple[str, ...] = (),
    posterior: int = 0,
    told: Callable[[str], None] = lambda _: None,
) -> Fitted:
    """Fit in a folder; `Stopped` where it was told to stop: the same call goes on."""
    from mpm.fit.write import write

    problem = read(experiment, hold_out, short=options is not None and options.smoke)
    if posterior:
        from mpm.fit.posterior import needed

        needed()
    out = out or default_out(experiment)
    paths = [parameter.path for parameter in problem.parameters]
    rounds = Rounds(bare(experiment), paths, out, options, reporter)
    with rounds:
        done = solve(problem, rounds.run, posterior, told)
        plan, done.counts = rounds.collect()
        done.ran, done.compiling = rounds.ran, rounds.compiling
        done.dataset = write(done, rounds, plan)
    return done


def fit(experiment: Any, out: Path | str | None = None, jobs: int | str = "auto", hold_out: tuple[str, ...] = (), posterior: int = 0, **more: Any) -> Any:
    """`mpm.fit`: the best values, their intervals and what cannot be told apart, as an xarray.DataTree (OUT/fit.nc).

    hold_out   curves that are predicted and not fitted; posterior: steps of emcee's walkers (extra `posterior`), 0 for none
    more       the other fields of `mpm.sweep.engine.Options`
    """
    from mpm.records.provenance import cores

    options = Options(jobs=cores() if jobs == "auto" else int(jobs), **more)
    try:
        done = run(experiment, Path(out) if out is not None else None, options, None, tuple(hold_out), posterior)
    except Stopped as stopped:
        if stopped.why in ("interrupted", "terminated"):
            raise KeyboardInterrupt from None
        raise OSError(str(stopped)) from None
    return tree_of(done.dataset)
