"""The material point: no grid, no neighbours; one particle's physics under a prescribed history (docs/physics.md 10, 0-D).

A batch of points with the same kinds of laws is one structure of arrays; one compiled call carries all of them. A single point is a batch of one.

state.py    Matter (laws and state of a batch), Program (what is prescribed, when), columns of the record
pick.py     role `pick(law, i)`: the law of point i from a law of arrays; `stack` makes such a law
heat.py     temperature and enthalpy of a point; role `exchange`
step.py     role `relaxation`; one step: heat, strain, flow, heating, stress; directions with prescribed stress by Newton
time_loop.py    the loop over points, output times and steps
run.py      solve(...): arrays -> Runs

A point stands for one cubic metre of undeformed material: its mass is the density, its energies are per reference volume.
From configs: mpm.scene.point; many at once: mpm.runner.run_points. To add a law: write it in mpm.materials, register it with `pick`
(tests/point/test_batch.py asks for it), a flow law with `relaxation` too.
"""

from mpm.point.run import solve
from mpm.point.state import HELD, NOMINAL, STRESS, Lumped, Matter, Program, Sourced

__all__ = ["HELD", "NOMINAL", "STRESS", "Lumped", "Matter", "Program", "Sourced", "solve"]
