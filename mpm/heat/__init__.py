"""Heat at particles and surfaces of bodies that move.

local.py     thermal stress, elastic and dissipative heating, temperature rise through enthalpy
lanes.py      the same over lanes: heating of eight particles, laws and rises of a row
exchange.py  meet(surface, s, theta, ...): every exchange of a piece as beta (outside - theta) + q; radiation by its secant
programmes.py  temperatures over time
setting.py   degree of setting: how it grows, what laws are asked with
surface.py   area_and_offset(space, ...): a surface piece in the current shape
The heat step itself, which needs transfers and walls too, is integrate/heat_step.py; bodies that do not move are mpm.rigid.
Absent       Isothermal(), NoExchange(), NoExpansion(), NoHeating(), NoSetting(): nothing stored, compiled or computed
May use      mpm.materials, mpm.state, mpm.jit          May not  see grids
To add       a role's sibling beside the others, its NamedTuple in mpm.state, its name in config
"""
