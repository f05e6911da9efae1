"""What is fitted: `fit: {parameters: {kappa: [0.1, 1], beta: {log: [1, 100]}}, data: [centre, crust]}`."""

from typing import Annotated, Any

from mpm.config.base import Model, doc
from mpm.config.quantities import Quantity
from mpm.config.sweep import Count, Seed, Span

Step = Annotated[float, Quantity("", "step", above=0, most=0.5)]


class Fit(Model):
    """Parameters that `mpm fit` finds from measured curves, by least squares."""

    parameters: dict[str, Span] = doc(min_length=1, description="parameter: [lowest, highest], or {log: [lowest, highest]} to step evenly in its logarithm")
    data: tuple[str, ...] = doc((), description="curves of output.measured that count; all unless given")
    starts: Count = doc(1, description="how many times the search begins: at the config's own values, then at points spread over the ranges")
    step: Step = doc(1e-3, description="distance of the points for derivatives, as a share of the parameter; more where the answer is rough")
    seed: Seed = doc(0, description="the same seed gives the same further starts")


def ranges(fit: Any) -> Any:
    """The same as a sweep, which knows how to read names and ranges."""
    from mpm.config.sweep import Sweep, Uniform

    return Sweep(sample=Uniform(count=1, seed=fit.seed, ranges=dict(fit.parameters)))
