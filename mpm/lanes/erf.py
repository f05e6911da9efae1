"""Error function over lanes, branch-free. Source of the rational approximations: fdlibm (Sun Microsystems 1993), s_erf.c.

erf(x)    any x, NaN stays NaN; within 2 ulp of one. What fdlibm splits to keep digits of 1 - erf is not: only erf itself is precise.
A number instead of lanes goes to the library.
"""

import math

import numpy as np

from mpm.jit import kernel
from mpm.lanes.arithmetic import absolute, like
from mpm.lanes.functions import exponential_lanes, generic, polynomial
from mpm.lanes.order import below, choose, minimum

SMALL, MIDDLE, LARGE, ALL = 0.84375, 1.25, 1.0 / 0.35, 6.0  # up to: near 0; near 1; tail; tail further out; 1 beyond
ONE = 8.45062911510467529297e-01  # erf(1), rounded
NEAR = (
    (-2.37630166566501626084e-05, -5.77027029648944159157e-03, -2.84817495755985104766e-02, -3.25042107247001499370e-01, 1.28379167095512558561e-01),
    (-3.96022827877536812320e-06, 1.32494738004321644526e-04, 5.08130628187576562776e-03, 6.50222499887672944485e-02, 3.97917223959155352819e-01, 1.0),
)  # fmt: skip
ABOUT_ONE = (
    (-2.16637559486879084300e-03, 3.54783043256182359371e-02, -1.10894694282396677476e-01, 3.18346619901161753674e-01, -3.72207876035701323847e-01,
     4.14856118683748331666e-01, -2.36211856075265944077e-03),
    (1.19844998467991074170e-02, 1.36370839120290507362e-02, 1.26171219808761642112e-01, 7.18286544141962662868e-02, 5.40397917702171048937e-01,
     1.06420880400844228286e-01, 1.0),
)  # fmt: skip
TAIL = (
    (-9.81432934416914548592e+00, -8.12874355063065934246e+01, -1.84605092906711035994e+02, -1.62396669462573470355e+02, -6.23753324503260060396e+01,
     -1.05586262253232909814e+01, -6.93858572707181764372e-01, -9.86494403484714822705e-03),
    (-6.04244152148580987438e-02, 6.57024977031928170135e+00, 1.08635005541779435134e+02, 4.29008140027567833386e+02, 6.45387271733267880336e+02,
     4.34565877475229228821e+02, 1.37657754143519042600e+02, 1.96512716674392571292e+01, 1.0),
)  # fmt: skip
FURTHER = (
    (-4.83519191608651397019e+02, -1.02509513161107724954e+03, -6.37566443368389627722e+02, -1.60636384855821916062e+02, -1.77579549177547519889e+01,
     -7.99283237680523006574e-01, -9.86494292470009928597e-03),
    (-2.24409524465858183362e+01, 4.74528541206955367215e+02, 2.55305040643316442583e+03, 3.19985821950859553908e+03, 1.53672958608443695994e+03,
     3.25792512996573918826e+02, 3.03380607434824582924e+01, 1.0),
)  # fmt: skip


@kernel(inline=True)
def erf_lanes(x, most):
    size, one = absolute(x), like(x, 1.0)
    a = minimum(like(x, ALL), size)  # in this order a NaN stays
    z = minimum(one, a)
    near = a + a * (polynomial(z * z, NEAR[0]) / polynomial(z * z, NEAR[1]))
    s = a - 1.0
    about = ONE + polynomial(s, ABOUT_ONE[0]) / polynomial(s, ABOUT_ONE[1])
    b = choose(below(a, one), one, a)  # no division by 0 in plain Python
    s = 1.0 / (b * b)
    ratio = choose(below(b, like(x, LARGE)), polynomial(s, TAIL[0]) / polynomial(s, TAIL[1]), polynomial(s, FURTHER[0]) / polynomial(s, FURTHER[1]))
    tail = 1.0 - exponential_lanes(ratio - 0.5625 - b * b, most) / b
    found = choose(below(a, like(x, SMALL)), near, choose(below(a, like(x, MIDDLE)), about, tail))
    return choose(below(x, like(x, 0.0)), -found, found)


def erf(x):
    return np.array([math.erf(one) for one in x], dtype=x.dtype) if np.ndim(x) else math.erf(x)


generic(erf, erf_lanes, math.erf, 700.0, 85.0)
