"""What a config's `sources` are to a run of moving bodies (integrate/given_source.py applies it)."""

from typing import Any, NamedTuple

import numpy as np

from mpm.state import PER_PARTICLE


class Given(NamedTuple):
    """Body force and heat that the config gives, over place, time and temperature (integrate/given_source.py)."""

    X: np.ndarray  # (N, D) place at the start, in the config's coordinates [m]
    t: np.ndarray  # (N,) time of the particle [s]
    b: np.ndarray  # (N, D) force by mass now [m/s2]
    rest: np.ndarray  # (N,) what a temperature in float32 had no digits for, so far [K]
    stack: np.ndarray  # (depth, N) scratch of formulas
    theta: np.ndarray  # (N,) scratch [K]
    force: Any  # Force, Jumping or NoForce
    heat: Any  # Warming or NoWarming


class Force(NamedTuple):
    """Force by mass, one formula a direction [m/s2]."""

    codes: tuple  # of mpm.sources.Code


class Jumping(NamedTuple):
    """Force by mass that jumps at some time."""

    codes: tuple
    past: np.ndarray  # (1,) share of the first impulse of a block of steps that acts before the block (mpm.contact.course)


class NoForce(NamedTuple):
    """No body force."""


class Warming(NamedTuple):
    """Heat by mass [W/kg]."""

    code: Any  # mpm.sources.Code


class NoWarming(NamedTuple):
    """No heat from within."""


class Both(NamedTuple):
    """Loads, and what else the config gives."""

    load: Any  # Load, or Both
    given: Any  # Given, Load or Both


def acting(source) -> list:
    """What acts on a body, one by one."""
    return [*acting(source.load), *acting(source.given)] if isinstance(source, Both) else [source]


PER_PARTICLE[Given] = ("X", "t", "b", "rest")
