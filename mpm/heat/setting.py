"""The degree of setting of a body's particles: how it grows, and what laws are asked with (docs/physics.md 18).

X <- 1 - (1 - X) exp(-dt (k_before + k)/2): exact at constant temperature, of order 2 along a ramp. Called after each heat step, at the new temperature.
"""

import math

import numpy as np

from mpm.heat.local import temperature
from mpm.jit import kernel, role
from mpm.lanes import EIGHT, put
from mpm.materials import Condition, value
from mpm.state import NoSetting, Setting, Thermal


@role
def condition(setting, thermal, i):
    """What the mechanical laws of particle i are asked with: its temperature [K], and with it X where it sets."""
    raise TypeError(f"no setting in {type(setting).__name__}")


@condition.register(NoSetting)
def condition_no_setting(setting, thermal, i):
    return temperature(thermal, i)


@condition.register(Setting)
def condition_setting(setting, thermal, i):
    return Condition(temperature(thermal, i), setting.X[i])


@role(inline=True)
def conditions_eight(setting, theta, first, count):
    """The same of eight particles from `first` on, `count` of which there are, at lanes of temperatures."""
    raise TypeError(f"no setting in {type(setting).__name__}")


@conditions_eight.register(NoSetting)
def conditions_eight_no_setting(setting, theta, first, count):
    return theta


@conditions_eight.register(Setting)
def conditions_eight_setting(setting, theta, first, count):
    X = theta
    for k in range(EIGHT):
        X = put(X, k, setting.X[first + min(k, count - 1)])
    return Condition(theta, X)


@role
def set_one(setting, thermal, i, dt):
    """Let particle i set for dt [s] up to its present temperature."""
    raise TypeError(f"no setting in {type(setting).__name__}")


@set_one.register(NoSetting)
def set_one_no_setting(setting, thermal, i, dt):
    return None


@set_one.register(Setting)
def set_one_setting(setting, thermal, i, dt):
    k = value(setting.rate, temperature(thermal, i))
    setting.X[i] -= (1.0 - setting.X[i]) * math.expm1(-0.5 * dt * (k + setting.k[i]))
    setting.k[i] = k


@kernel
def set_all(setting, thermal, dt):
    """`set_one` of every particle."""
    for i in range(setting.X.shape[0]):
        set_one(setting, thermal, i, dt)


def set_bodies(bodies, dt: float) -> None:
    """Let every body that sets do so for dt [s]."""
    for body in bodies:
        if isinstance(body.setting, Setting):
            set_all(body.setting, body.thermal, dt)


def conditions(body) -> np.ndarray:
    """What the mechanical laws of a body's particles are asked with: (N,) temperatures [K], or (N, 2) with X where it sets."""
    if isinstance(body.thermal, Thermal):
        theta = body.thermal.zero + body.thermal.theta.astype(float)
    else:
        theta = np.full(len(body.particles.m), body.thermal.temperature)
    return np.stack([theta, body.setting.X], axis=1) if isinstance(body.setting, Setting) else theta
