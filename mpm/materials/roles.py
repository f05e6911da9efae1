"""What a material is asked. Each function is chosen by the type of its first argument (mpm.jit.role); the package docstring has the contract."""

from mpm.jit import role


def missing(law, what):
    return TypeError(f"{type(law).__name__} does not know `{what}`")


@role
def stress(law, e1, e2, e3, thermal):
    """Principal Kirchhoff stresses t1, t2, t3 [Pa] of principal elastic Hencky strains [-] and a thermal stress gamma (Theta - Theta_0) [Pa]."""
    raise missing(law, "stress")


@role
def energy(law, e1, e2, e3):
    """Isothermal strain energy per reference volume [J/m3]."""
    raise missing(law, "energy")


@role
def moduli(law):
    """Lame constants (lam, mu) [Pa] at zero strain: for return maps and time-step limits."""
    raise missing(law, "moduli")


@role
def flow(law, elastic, e1, e2, e3, thermal, theta, dt):
    """Elastic strains at the end of a step from the trial ones: (e1, e2, e3, dissipated, ok).

    Pure: depends on its arguments only. Equal to the trial strains, bit for bit, where nothing flows. `dissipated` >= 0 is the step's
    plastic work per reference volume [J/m3], `ok` false where the map failed: then the strains are the trial ones.
    """
    raise missing(law, "flow")


@role
def warmed(law, theta):
    """The elastic law at temperature theta [K]: what `stress`, `energy`, `moduli` and `flow` are asked with. Itself where nothing follows temperature."""
    raise missing(law, "warmed")


@role
def settled(law, J):
    """The flow law at a total volume ratio J: itself where nothing follows porosity."""
    raise missing(law, "settled")


@role
def at_volume(law, J):
    """A parameter at a total volume ratio J: itself where it does not follow porosity."""
    raise missing(law, "at_volume")


@role
def value(law, theta):
    """The parameter at temperature theta [K]."""
    raise missing(law, "value")


@role
def enthalpy(law, theta):
    """A primitive of `value` over temperature, exact: specific enthalpy [J/kg] where the parameter is a specific heat."""
    raise missing(law, "enthalpy")


@role
def temperature_of(law, h, guess):
    """The theta with enthalpy(law, theta) = h, to round-off, for a positive law: exact through any latent heat. `guess` [K] only saves time."""
    raise missing(law, "temperature_of")


@role(inline=True)
def values(law, theta):
    """`value` over lanes of temperatures [K]."""
    raise missing(law, "values")


@role(inline=True)
def enthalpies(law, theta):
    """`enthalpy` over lanes of temperatures [K]."""
    raise missing(law, "enthalpies")


@role(inline=True)
def temperatures(law, h, guess):
    """`temperature_of` over lanes."""
    raise missing(law, "temperatures")


@role(inline=True)
def aspects(law, theta, J):
    """p0 over lanes of temperatures [K] and volume ratios [-]."""
    raise missing(law, "aspects")


@role(inline=True)
def moduli_lanes(law, theta):
    """`moduli` of the elastic law over lanes of temperatures [K]."""
    raise missing(law, "moduli_lanes")


@role(inline=True)
def flow_lanes(law, trace, deviator, lam, mu, thermal, theta, J, dt):
    """`flow` over lanes, of the trace of the trial strain and the norm of its deviator: (trace, share, dissipated, flowed, good).

    The strain at the end is trace/3 + share times the trial deviator. flowed 1 where anything flows: elsewhere trace is the trial one, bit for bit, and
    share 1; good 0 where the map failed. dt > 0.
    """
    raise missing(law, "flow_lanes")


@role
def tangent(law, elastic, trace, size, thermal, theta, dt):
    """The incremental potential of a step and its slopes, of trace and deviator's norm of the trial strain: (W, p, share, c11, c12, c22, dissipated, good).

    W(eps_tr) [J/m3] is convex with dW/deps_tr = tau, p [Pa] the mapped pressure, share = q/q_tr; c11 = dp/dp_tr, c22 = dq/dq_tr and
    c12 = dp/dq_tr = (3 mu/K)^-1 dq/dp_tr. dissipated >= 0 [J/m3]; good false where the map failed (docs/physics.md 17).
    """
    raise missing(law, "tangent")


@role
def response(elastic, law, trace, d, size, thermal, theta, dt, tau, a):
    """`tangent` along the axes of the trial strain, trace/3 + d with |d| = size, of elastic and flow law together: (W, share, good).

    tau (3,) <- principal stresses [Pa], a (3, 3) <- dtau_i/deps_j; share = q/q_tr.
    """
    raise missing(elastic, "response")


@role
def turning(elastic, share, li, lj):
    """(tau_i - tau_j)/(l_i - l_j) [Pa] of two eigenvalues of b_tr less one, exact where they are equal; share as `response` gives it."""
    raise missing(elastic, "turning")
