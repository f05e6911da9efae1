"""Enthalpy as the variable: temperature and Kirchhoff's potential as functions of specific enthalpy, tabulated.

    h(theta) = int_zero^theta alpha,   Pi(theta) = int_zero^theta kappa,   both from mpm.materials.laws (the bump's by erf, the step's by log1p)

`Table` holds theta(h) and Pi(theta(h)) as cubic Hermite pieces of equal length in h, halved until the largest error at the pieces' middles is below 1e-9 of the
range; beyond the range both go on as straight lines. One kind of table for every pair of laws: one compile, one look-up a node.
Temperatures are relative to `zero`.
"""

from typing import NamedTuple

import numpy as np

from mpm.jit import kernel, role
from mpm.materials.roles import enthalpy, temperature_of, value

PIECES, MOST_PIECES, CLOSE = 512, 1 << 14, 1e-9


class Table(NamedTuple):
    """Pieces k = 1..n of length 1/per in h from `start`; k = 0 and n + 1 are the straight ends."""

    start: float  # h at the start of piece 1 [J/kg]
    per: float  # pieces a J/kg
    theta: np.ndarray  # (n + 2, 4) theta - zero = c0 + t (c1 + t (c2 + t c3)), t in [0, 1] in the piece [K]
    potential: np.ndarray  # (n + 2, 4) the same for Pi [W/m]
    steepest: float  # largest d theta/d h [kg K/J]
    conductivity: float  # largest kappa [W/(m K)]


class Tables(NamedTuple):
    """Of several bodies B: node i looks in the table of the body which[i]. What is behind a shorter table repeats its end."""

    which: np.ndarray  # (N,)
    start: np.ndarray  # (B,) as Table
    per: np.ndarray  # (B,)
    top: np.ndarray  # (B,) number of the last piece
    theta: np.ndarray  # (B, n + 2, 4)
    potential: np.ndarray  # (B, n + 2, 4)
    steepest: float
    conductivity: float


@role(inline=True)
def piece(table, i, h):
    """Of node i at enthalpy h: place in a piece of its table, the piece's coefficients of theta and of Pi, pieces a J/kg."""
    raise TypeError(f"no table {type(table).__name__}")


@piece.register(Table)
def piece_table(table, i, h):
    s = (h - table.start) * table.per
    k = min(max(int(np.floor(s)) + 1, 0), len(table.theta) - 1)
    c, p = table.theta, table.potential
    return s - (k - 1), (c[k, 0], c[k, 1], c[k, 2], c[k, 3]), (p[k, 0], p[k, 1], p[k, 2], p[k, 3]), table.per


@piece.register(Tables)
def piece_tables(table, i, h):
    b = table.which[i]
    s = (h - table.start[b]) * table.per[b]
    k = min(max(int(np.floor(s)) + 1, 0), table.top[b])
    c, p = table.theta, table.potential
    return s - (k - 1), (c[b, k, 0], c[b, k, 1], c[b, k, 2], c[b, k, 3]), (p[b, k, 0], p[b, k, 1], p[b, k, 2], p[b, k, 3]), table.per[b]


@kernel
def sample(alpha, kappa, zero, h, theta):
    """Rows (theta - zero, 1/alpha, Pi, kappa/alpha) at enthalpies h above that of `zero`; `theta` is the first guess, and moves along."""
    out = np.empty((len(h), 4))
    h0, p0 = enthalpy(alpha, zero), enthalpy(kappa, zero)
    for k in range(len(h)):
        theta = temperature_of(alpha, h0 + h[k], theta)
        a = value(alpha, theta)
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = theta - zero, 1.0 / a, enthalpy(kappa, theta) - p0, value(kappa, theta) / a
    return out


@kernel
def enthalpies(alpha, zero, theta):
    """h above that of `zero` at temperatures theta [K]."""
    out = np.empty(len(theta))
    h0 = enthalpy(alpha, zero)
    for k in range(len(theta)):
        out[k] = enthalpy(alpha, theta[k]) - h0
    return out


def _hermite(f, df, step):
    """(n + 2, 4) coefficients from values and slopes at the n + 1 ends."""
    c = np.zeros((len(f) + 1, 4))
    a, b, rise = df[:-1] * step, df[1:] * step, np.diff(f)
    c[1:-1] = np.stack([f[:-1], a, 3 * rise - 2 * a - b, a + b - 2 * rise], axis=-1)
    c[0, :2] = f[0] - df[0] * step, df[0] * step
    c[-1, :2] = f[-1], df[-1] * step
    return c


def make_table(alpha, kappa, zero: float, coldest: float, hottest: float) -> Table:
    """The table of the laws alpha(theta), kappa(theta) for temperatures from `coldest` to `hottest` [K], a tenth of the span added at both ends."""
    margin = 0.1 * (hottest - coldest) + 1.0
    rising = enthalpies(alpha, zero, np.linspace(coldest - margin, hottest + margin, PIECES))
    low, high = rising[0], rising[-1]
    n = PIECES
    while True:
        ends = np.linspace(low, high, n + 1)
        step = (high - low) / n
        at = sample(alpha, kappa, zero, ends, coldest)
        middle = sample(alpha, kappa, zero, ends[:-1] + 0.5 * step, coldest)
        if not (np.isfinite(at).all() and (np.diff(rising) > 0).all() and (at[:, 1] > 0).all() and (at[:, 3] >= 0).all()):
            raise ValueError(f"alpha must be positive and kappa not negative between {coldest - margin:.6g} and {hottest + margin:.6g} K")
        tables = [_hermite(at[:, k], at[:, k + 1], step) for k in (0, 2)]
        error = max(np.abs(c[1:-1] @ [1, 0.5, 0.25, 0.125] - middle[:, k]).max() / (np.ptp(at[:, k]) or 1.0) for c, k in zip(tables, (0, 2), strict=True))
        if error <= CLOSE or n >= MOST_PIECES:
            here = int(min(max(np.floor(-low / step), 0), n - 1)) + 1
            for c in tables:  # theta(0) = Pi(0) = 0 to the last bit: a body at rest stays at rest
                c[:, 0] -= np.polynomial.polynomial.polyval(-low / step - (here - 1), c[here])
            conductivity = float(np.max(np.concatenate([at[:, 3] / at[:, 1], middle[:, 3] / middle[:, 1]])))
            return Table(low, 1 / step, *tables, float(max(at[:, 1].max(), middle[:, 1].max())), conductivity)
        n *= 2


@kernel
def look_up(table, h, theta, potential, slope, conductance):
    """theta - zero, Pi, d theta/d h and d Pi/d h at enthalpies h (N,), into the four arrays."""
    for i in range(len(h)):
        t, c, p, per = piece(table, i, h[i])
        theta[i] = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
        slope[i] = (c[1] + t * (2.0 * c[2] + t * 3.0 * c[3])) * per
        potential[i] = p[0] + t * (p[1] + t * (p[2] + t * p[3]))
        conductance[i] = (p[1] + t * (2.0 * p[2] + t * 3.0 * p[3])) * per


@kernel
def temperatures(table, h):
    """theta - zero at enthalpies h (N,)."""
    out = np.empty(len(h))
    for i in range(len(h)):
        t, c, _, _ = piece(table, i, h[i])
        out[i] = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
    return out
