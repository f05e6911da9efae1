from mpm.rigid.run import Method, RigidRun, solve
from mpm.rigid.system import RigidBody
