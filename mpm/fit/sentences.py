"""The answer in words."""

import math
from typing import Any

import numpy as np

from mpm.records.variables import describe
from mpm.text import amount, figure

LOOSE = 0.1  # relative standard error from which parameters that move together are said not to be told apart
CHANCE = 0.01  # if the model were right, so few held-out values within their 95 % band would be less likely than this: then it is called unpredicted


def unit(units: str) -> str:
    """A unit behind a number."""
    return "" if units in ("", "1") else f" {units.replace('**', '').replace('*', ' ')}"


def limits(done: Any, k: int) -> tuple[float, float, bool, bool]:
    """(lower, upper, whether each is a limit and not the end of the range) of a parameter by its profile; by the covariance where there is none."""
    parameter = done.problem.parameters[k]
    pair = [side for side in done.sides if side.k == k]
    if len(pair) < 2 or any(side.state == "lost" for side in pair):
        low, high = map(float, done.known.interval()[k])
        return max(low, parameter.low), min(high, parameter.high), low >= parameter.low, high <= parameter.high
    return (*(float(parameter.from_u(side.limit)) for side in pair), *(side.state == "found" for side in pair))


def sentences(done: Any) -> list[str]:
    """What a user wants to know, the numbers first."""
    problem, known, said = done.problem, done.known, []
    for k, parameter in enumerate(problem.parameters):
        value, error = known.values[k], known.error[k]
        low, high, closed_low, closed_high = limits(done, k)
        text = f"{parameter.name} {amount(value, error)}{unit(parameter.units)}"
        if known.variance > 0:
            span = f"{'' if closed_low else 'below '}{figure(low, error)} to {'' if closed_high else 'above '}{figure(high, error)}"
            text += f" (95 %: {span}" + ("" if closed_low and closed_high else ": the data set no limit within the range") + ")"
        if min(value - parameter.low, parameter.high - value) <= 1e-3 * (parameter.high - parameter.low):
            text += f"; it lies at the end of its range, {parameter.low:.4g} to {parameter.high:.4g}: widen it"
        said.append(text)
    said += [misfit(done, curve) for curve in problem.curves]
    for pair in done.pairs:
        said.append(together(done, pair))
    said += held(done) + doubts(done)
    return said


def misfit(done: Any, curve: Any) -> str:
    """How far a curve is off."""
    predicted = curve.predict(done.evaluator.records([done.known.u])[0])
    rms = float(np.sqrt(np.mean((predicted - curve.values) ** 2)))
    what = describe(curve.variable, None, done.problem.experiment.output.probes).long_name
    late = f"; {curve.late} more after the end of the run" if curve.late else ""
    return f"{curve.name}: {rms:.3g}{unit(curve.units)} rms off {len(curve.values)} measured value{'s' * (len(curve.values) != 1)} ({what}){late}"


def together(done: Any, pair: Any) -> str:
    """Two parameters that cannot be told apart."""
    a, b = (done.problem.parameters[k].name for k in (pair.i, pair.j))
    power = f"{abs(pair.power):.2g}"
    if pair.product:
        fixed = f"{a} x {b}^{power}" if pair.power >= 0 else f"{a} / {b}^{power}"
        share = 100 * pair.error / abs(pair.value)
        fixed += f" = {pair.value:.3g} ± {share:.2g} % is fixed"
    else:
        fixed = f"{a} {'+' if pair.power >= 0 else '-'} {power} {b} = {amount(pair.value, pair.error)} is fixed"
    curves = " and ".join(curve.name for curve in done.problem.curves)
    known = done.known
    if all(known.error[k] < LOOSE * abs(known.values[k]) for k in (pair.i, pair.j)):
        return f"{a} and {b} move together (correlation {pair.correlation:.3f}), though each is known: {fixed}"
    text = f"with {curves} alone {a} and {b} cannot be told apart (correlation {pair.correlation:.3f}): {fixed}"
    better = {name: error for name, error in done.gains.items() if error[pair.i] < 0.5 * done.known.error[pair.i]}
    if better:
        name = min(better, key=lambda one: better[one][pair.i])
        measured = name in done.problem.experiment.output.measured
        now, then = done.known.error[pair.i], better[name][pair.i]
        held_out = measured and name in [curve.name for curve in done.problem.held]
        how = "fit it too instead of holding it out" if held_out else f"add {name} to fit.data" if measured else "measure there too"
        text += f"; the curve of {name} would: {a} ± {then:.2g} instead of ± {now:.2g} ({how})"
    return text


def held(done: Any) -> list[str]:
    """What was predicted and not fitted."""
    from scipy.stats import binom

    from mpm.fit.identify import LEVEL, band

    said = []
    for curve in done.problem.held:
        predicted, half = band(done.evaluator, done.known, curve.predict)
        off = predicted - curve.values
        noise = curve.sigma if curve.sigma is not None else math.sqrt(max(done.known.variance, 0.0) / curve.weight)
        within = int(np.sum(np.abs(off) <= np.sqrt(half**2 + (done.known.quantile * noise) ** 2)))
        good = "" if binom.cdf(within, len(off), LEVEL) >= CHANCE else ": the model, fitted to the rest, does not predict it"
        rms = f"{float(np.sqrt(np.mean(off**2))):.3g}{unit(curve.units)} rms"
        said.append(f"{curve.name}, held out: {rms}, {100 * within / len(off):.0f} % of its values within the 95 % band{good}")
    return said


def doubts(done: Any) -> list[str]:
    """What a careful user wants to know of the intervals."""
    problem, known = done.problem, done.known
    said = [f"{name} is left out: it was measured after the end of this short run" for name in problem.left_out]
    if not done.searches.best.converged:
        said.append(f"the search did not converge: {done.searches.best.why}")
    elif not done.converged:
        way = ", and failed points stand in its way" if done.evaluator.failed else ""
        said.append(f"the search ended short of the optimum{way}: the values and intervals are not to be trusted")
    if len(done.searches.found) > 1:
        low, high = problem.bounds
        said.append(f"{done.searches.alike(high - low)} of {len(done.searches.found)} starts led to this optimum")
    said += done.searches.told
    if failed := len(done.evaluator.failed):
        first = next(iter(done.evaluator.failed.values()))
        said.append(f"{failed} of {len(done.evaluator.known)} points failed, and the search went round them; the first: {first}")
    free = problem.size - len(problem.parameters)
    if problem.known_sigma and free > 0:
        ratio = float(known.residuals @ known.residuals) / free
        if ratio > 2:
            said.append(f"residuals are {math.sqrt(ratio):.2g} times sigma: the model is off by more than the measurement, and the intervals are too narrow")
    at = 0
    for curve in problem.curves:
        r = known.residuals[at : at + len(curve.values)]
        at += len(curve.values)
        if len(r) >= 8 and r.any() and (memory := float(r[:-1] @ r[1:] / (r @ r))) > 2 / math.sqrt(len(r)):
            said.append(f"residuals of {curve.name} follow one another (correlation {memory:.2f}): model error, not noise alone; the intervals are too narrow")
    if any(side.state == "lost" for side in done.sides):
        lost = sorted({problem.parameters[side.k].name for side in done.sides if side.state == "lost"})
        said.append(f"the profile of {' and '.join(lost)} did not come to an end; the interval is that of the covariance")
    return said
