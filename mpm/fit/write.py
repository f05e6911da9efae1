"""OUT/fit.nc: what was found, and every evaluation.

/             best, standard_error, interval, interval_covariance (parameter[, bound]); covariance, correlation (parameter, parameter_);
              misfit (curve, held out ones too), held_out; measured, fitted, band, residual (observation), which curve and time each is of
/profile      value, rise (place): rise of the sum of squares over that of the interval's end; parameter_of
/curves       fitted_<curve>, band_<curve> (time): half width of the 95 % confidence band
/posterior    draw (draw, parameter), where it was sampled
/evaluations  the dataset of every point tried (dims point), /evaluations/series its series
"""

import math
from pathlib import Path
from typing import Any

import numpy as np

from mpm.fit.identify import band
from mpm.fit.sentences import limits, sentences
from mpm.records.netcdf import Array, DamagedFile, Group, to_bytes, write_whole
from mpm.records.provenance import git_revision, machine, versions
from mpm.sweep.case_list import swept_paths
from mpm.sweep.table import Table


def write(done: Any, rounds: Any, plan: Any) -> Path:
    """The file."""
    groups = {"/": root(done), "profile": places(done), "curves": curves(done)}
    if done.chain is not None:
        groups["posterior"] = Group({"parameter": names(done), "draw": Array(("sample", "parameter"), done.chain, {"units": "1", "long_name": "draw"})})
    laid = Table(plan)
    for _, record in rounds.store.load_all(list(dict.fromkeys(case.run_id for case in plan.cases)), fields=False):
        if not isinstance(record, DamagedFile):
            laid.add(record)
    groups |= {"evaluations": laid.root(swept_paths(plan)), "evaluations/series": laid.series()}
    experiment = done.problem.experiment
    attrs = {"Conventions": "CF-1.11", "title": experiment.title or experiment.name, "name": experiment.name, "config": experiment.source,
             "config_resolved": experiment.resolved(), "sentences": sentences(done), "converged": int(done.converged),
             "evaluations": len(done.evaluator.known), "failed": len(done.evaluator.failed), "sigma_known": int(done.problem.known_sigma),
             "residual_variance": done.known.variance, "versions": versions(), "git_revision": git_revision(), "machine": machine()}  # fmt: skip
    path = rounds.store.out / "fit.nc"
    write_whole(path, to_bytes(groups, attrs))
    return path


def names(done: Any, dim: str = "parameter") -> Array:
    """Names of the parameters along a dimension."""
    return Array((dim,), np.array(done.problem.names, dtype=object), {"long_name": "parameter"})


def root(done: Any) -> Group:
    """The numbers."""
    problem, known = done.problem, done.known
    texts = lambda values: np.array(list(values), dtype=object)  # noqa: E731
    about = lambda words: {"units": "1", "long_name": words, "comment": "in the unit of each parameter, parameter_units"}  # noqa: E731
    interval = np.array([limits(done, k)[:2] for k in range(len(problem.parameters))])
    shown = (*problem.curves, *problem.held)
    record = done.evaluator.records([known.u])[0]
    predicted = [curve.predict(record) for curve in shown]
    misfit = [float(np.sqrt(np.mean((p - c.values) ** 2))) for p, c in zip(predicted, shown, strict=True)]
    halves = [band(done.evaluator, known, curve.predict)[1] for curve in shown]
    which = np.concatenate([np.full(len(curve.values), k, np.int32) for k, curve in enumerate(shown)])
    times = np.concatenate([np.full(len(c.values), math.nan) if c.times is None else c.times for c in shown])
    measured, fitted = np.concatenate([curve.values for curve in shown]), np.concatenate(predicted)
    spread = math.sqrt(max(known.variance, 0.0))
    sigma = np.concatenate([np.full(len(curve.values), spread / math.sqrt(curve.weight)) if curve.sigma is None else curve.sigma for curve in shown])
    row = lambda values, words: Array(("observation",), values, {"units": "1", "long_name": words, "comment": "in the unit of its curve, curve_units"})  # noqa: E731
    return Group({
        "parameter": names(done), "parameter_": names(done, "parameter_"), "bound": Array(("bound",), texts(["lower", "upper"])),
        "best": Array(("parameter",), known.values, about("best value")),
        "standard_error": Array(("parameter",), known.error, about("standard error")),
        "interval": Array(("parameter", "bound"), interval, about("95 % interval by profile likelihood")),
        "interval_covariance": Array(("parameter", "bound"), known.interval(), about("95 % interval by the covariance")),
        "covariance": Array(("parameter", "parameter_"), known.covariance_si, about("covariance")),
        "correlation": Array(("parameter", "parameter_"), known.correlation, {"units": "1", "long_name": "correlation"}),
        "range": Array(("parameter", "bound"), np.array([(p.low, p.high) for p in problem.parameters]), about("range that was searched")),
        "parameter_units": Array(("parameter",), texts(p.units for p in problem.parameters), {"long_name": "unit"}),
        "parameter_long_name": Array(("parameter",), texts(p.long_name for p in problem.parameters), {"long_name": "what it is"}),
        "config_path": Array(("parameter",), texts(p.path for p in problem.parameters), {"long_name": "path in the config"}),
        "curve": Array(("curve",), texts(c.name for c in shown), {"long_name": "measured curve"}),
        "curve_units": Array(("curve",), texts(c.units for c in shown), {"long_name": "unit"}),
        "variable": Array(("curve",), texts(c.variable for c in shown), {"long_name": "what was measured"}),
        "misfit": Array(("curve",), np.array(misfit), {"units": "1", "long_name": "root-mean-square residual", "comment": "in curve_units"}),
        "held_out": Array(("curve",), np.array([0] * len(problem.curves) + [1] * len(problem.held), np.int8), {"units": "1", "long_name": "1 where predicted"}),
        "curve_of": Array(("observation",), which, {"units": "1", "long_name": "place of the curve"}),
        "measured_time": Array(("observation",), times, {"units": "s", "long_name": "time of the measurement"}),
        "measured": row(measured, "measured value"), "fitted": row(fitted, "value of the model at the best parameters"),
        "band": row(np.concatenate(halves), "half width of the 95 % confidence band of the model"),
        "sigma": row(sigma, "standard error of the measurement, given or from the residuals"), "residual": row(fitted - measured, "model less measurement"),
    })  # fmt: skip


def places(done: Any) -> Group:
    """Profiles: the optimum is a place of each."""
    rise = done.known.quantile**2 * done.known.variance
    rows = [(k, float(done.known.values[k]), 0.0) for k in range(len(done.problem.parameters))]
    rows += [(side.k, float(done.problem.parameters[side.k].from_u(u)), s / rise) for side in done.sides for u, s in side.places]
    rows.sort()
    k, value, risen = (np.array(column) for column in zip(*rows, strict=True))
    return Group({
        "parameter_of": Array(("place",), k.astype(np.int32), {"units": "1", "long_name": "place of the parameter"}),
        "value": Array(("place",), value, {"units": "1", "long_name": "value of the parameter", "comment": "in parameter_units"}),
        "rise": Array(("place",), risen, {"units": "1", "long_name": "rise of the sum of squares, 1 at the end of the 95 % interval"}),
    })  # fmt: skip


def curves(done: Any) -> Group:
    """The model over time at the best parameters."""
    record = done.evaluator.records([done.known.u])[0]
    group = Group({"time": Array(("time",), np.asarray(record.times), {"units": "s", "long_name": "time"})})
    for curve in (*done.problem.curves, *done.problem.held):
        if curve.times is None:
            continue

        def series(record: Any, variable: str = curve.variable) -> np.ndarray:
            return np.asarray(record.series[variable], dtype=float)

        fitted, half = band(done.evaluator, done.known, series)
        group.variables[f"fitted_{curve.name}"] = Array(("time",), fitted, {"units": curve.units, "long_name": f"model of {curve.name}"})
        group.variables[f"band_{curve.name}"] = Array(("time",), half, {"units": curve.units, "long_name": "half width of the 95 % confidence band"})
    return group
