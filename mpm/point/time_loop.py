"""The loop over points, output times and steps. Kinds are types, points are indices: a batch of any size is one compiled call."""

import math

import numpy as np

from mpm.heat.local import temperature, thermal_stress
from mpm.heat.setting import condition
from mpm.jit import kernel, role
from mpm.materials import energy, stress, warmed
from mpm.outcome import COMPLETED, INVERTED, MAX_PRINCIPLE, NON_FINITE, OVERSTRETCHED
from mpm.point.heat import above, content, datum, exchange
from mpm.point.pick import pick
from mpm.point.state import (
    CAUCHY,
    DISSIPATION,
    ELASTIC,
    ENERGY,
    EXCHANGED,
    HEAT,
    LOCAL,
    NO_EQUILIBRIUM,
    NOMINAL,
    RATE,
    STRAIN,
    STRESS,
    SWELL,
    TEMPERATURE,
    WIDTH,
    Matter,
    P,
    Q,
)  # fmt: skip
from mpm.point.step import shares, step
from mpm.state import NoSetting, Setting

MOST_STEPS = 1000.0  # automatic steps between two output times, at most: what relaxes faster is followed by its limit, which is stable
LONGEST = math.log(1e3)  # |ln J| past which a point has left the model


@kernel
def advance(matter, program, progress, out, rows):
    """Carry every point over at most `rows` more of its rows; out (R, WIDTH or more) is filled row by row. A point that fails stops at its last good row."""
    work, d, rates = np.zeros((8, 3)), np.zeros(3), np.zeros(3)
    for i in range(matter.density.shape[0]):
        one = Matter(
            matter.density[i],
            pick(matter.elastic, i),
            pick(matter.flow, i),
            pick(matter.thermal, i),
            pick(matter.exchange, i),
            pick(matter.expansion, i),
            pick(matter.heating, i),
            matter.elastic_strain[i],
            matter.strain[i],
            pick(matter.setting, i),
        )
        if progress.row[i] < 0:
            progress.zero[i] = content(one.thermal)
            enter(one, progress, i, progress.stage[i], 0.0)
            record(one, progress, i, out[program.first[i]])
            progress.row[i] = 0
        last = min(program.first[i + 1] - program.first[i] - 1, progress.row[i] + rows)
        while progress.row[i] < last and progress.code[i] == COMPLETED:
            row = program.first[i] + progress.row[i] + 1
            interval(one, program, progress, i, program.times[row - 1], program.times[row], (work, d, rates))
            if progress.code[i] == COMPLETED:
                progress.row[i] += 1
                record(one, progress, i, out[row])


@kernel
def enter(one, progress, i, stage, now):
    """Remember the state at the start of a stage."""
    entered = progress.entered[i]
    progress.stage[i] = stage
    entered[0], entered[1], entered[2], entered[3] = now, one.strain[0], one.strain[1], one.strain[2]
    entered[4] = above(one.thermal)


@kernel
def interval(one, program, progress, i, start, end, scratch):
    """From one output time to the next, cut at the ends of stages."""
    now = start
    while now < end:
        stage = progress.stage[i]
        until = program.until[i, stage]
        while stage < program.until.shape[1] - 1 and until <= now + 1e-12 * end:
            stage += 1
            enter(one, progress, i, stage, now)
            until = program.until[i, stage]
        until = end if until >= end * (1.0 - 1e-12) else until
        piece(one, program, progress, i, stage, now, until, end - start, scratch)
        if progress.code[i] != COMPLETED:
            return
        now = until


@kernel
def piece(one, program, progress, i, stage, start, end, span, scratch):
    """Equal steps from `start` to `end` within one stage; `span` is the output interval."""
    work, d, rates = scratch
    kind, value, entered = program.kind[i, stage], program.value[i, stage], progress.entered[i]
    goal = program.temperature[i, stage]
    held = not math.isnan(goal)
    ramp = ((goal - datum(one.thermal)) - entered[4]) / (program.until[i, stage] - entered[0]) if held else 0.0
    speed = 0.0
    for k in range(3):
        rates[k] = 0.0
        if kind[k] == RATE:
            rates[k] = value[k]
        elif kind[k] == NOMINAL:
            rates[k] = value[k] / math.exp(one.strain[k])
        speed = max(speed, abs(rates[k]))
    longest = program.step[i]
    if longest == 0.0:
        longest = max(program.safety[i] * min(shares(one, speed, abs(ramp))), span / MOST_STEPS)
    count = max(1, math.ceil((end - start) / longest * (1.0 - 1e-9))) if longest < end - start else 1
    dt = (end - start) / count
    for n in range(count):
        after = end if n == count - 1 else start + dt * (n + 1)
        for k in range(3):
            d[k] = rates[k] * dt
            if kind[k] == STRESS:
                d[k] = progress.rate[i, k] * dt
            elif kind[k] == NOMINAL:
                stretch = math.exp(entered[1 + k]) + value[k] * (after - entered[0])
                if not stretch > 0.0:
                    progress.code[i], progress.time[i] = INVERTED, start + dt * n
                    return
                d[k] = math.log(stretch) - one.strain[k]
        before = temperature(one.thermal, 0)
        total_before = content(one.thermal)
        gained = 0.0
        if held:
            base = entered[4] + ramp * (after - entered[0])
        else:
            gained = exchange(one.exchange, one.thermal, one.density, math.exp(one.strain[0] + one.strain[1] + one.strain[2]), dt)
            base = above(one.thermal)
        lost, heated, ok = step(one, one.elastic_strain, one.strain, d, kind, value, base, held, dt, work)
        progress.steps[i] += 1
        if not ok:
            progress.code[i], progress.time[i] = NO_EQUILIBRIUM, after
            return
        if held:
            gained = one.density * (content(one.thermal) - total_before) - heated
        progress.sums[i, 0] += lost
        progress.sums[i, 1] += gained
        progress.sums[i, 2] += heated
        for k in range(3):
            progress.rate[i, k] = d[k] / dt
        theta = temperature(one.thermal, 0)
        cross(program, progress, i, before, theta, after - dt, dt)
        swell = one.strain[0] + one.strain[1] + one.strain[2]
        if not math.isfinite(swell) or not math.isfinite(theta):
            progress.code[i], progress.time[i] = NON_FINITE, after
            return
        if not theta > 0.0:
            progress.code[i], progress.time[i] = MAX_PRINCIPLE, after
            return
        if not abs(swell) < LONGEST:
            progress.code[i], progress.time[i] = OVERSTRETCHED, after
            return
    progress.time[i] = end


@kernel(inline=True)
def cross(program, progress, i, before, after, start, dt):
    """First crossings of thresholds in a step from temperature `before` to `after`, linear in between."""
    for k in range(program.thresholds.shape[1]):
        goal = program.thresholds[i, k]
        if math.isnan(progress.crossed[i, k]) and after != before and (before - goal) * (after - goal) <= 0.0:
            progress.crossed[i, k] = start + dt * (goal - before) / (after - before)


@role
def record_setting(setting, row):
    """X behind the other columns, where the point sets."""
    raise TypeError(f"no setting in {type(setting).__name__}")


@record_setting.register(NoSetting)
def record_setting_no_setting(setting, row):
    return None


@record_setting.register(Setting)
def record_setting_setting(setting, row):
    row[WIDTH] = setting.X[0]


@kernel
def record(one, progress, i, row):
    """One row of output: COLUMNS of mpm.point.state."""
    e, total = one.elastic_strain, one.strain
    at = condition(one.setting, one.thermal, 0)
    elastic = warmed(one.elastic, at)
    t1, t2, t3 = stress(elastic, e[0], e[1], e[2], thermal_stress(one.expansion, one.thermal, 0, at))
    J = math.exp(total[0] + total[1] + total[2])
    for k in range(3):
        row[STRAIN + k], row[ELASTIC + k] = total[k], e[k]
    row[CAUCHY], row[CAUCHY + 1], row[CAUCHY + 2] = t1 / J, t2 / J, t3 / J
    row[P] = -(t1 + t2 + t3) / 3.0
    row[Q] = math.sqrt(0.5 * ((t1 - t2) * (t1 - t2) + (t2 - t3) * (t2 - t3) + (t3 - t1) * (t3 - t1)))
    row[SWELL] = J
    row[ENERGY] = energy(elastic, e[0], e[1], e[2])
    row[DISSIPATION] = progress.sums[i, 0]
    row[TEMPERATURE] = temperature(one.thermal, 0)
    row[HEAT] = one.density * (content(one.thermal) - progress.zero[i])
    row[EXCHANGED] = progress.sums[i, 1]
    row[LOCAL] = progress.sums[i, 2]
    record_setting(one.setting, row)
