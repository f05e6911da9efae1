"""What a rigid scene cannot use is refused, not passed over."""

import pytest

from mpm.scene.refusal import SceneError
from mpm.scene.rigid import rigid_bodies


@pytest.mark.parametrize(("change", "said"), [({"grid.basis": "cubic"}, "quadratic splines only"), ({"method.locking": "fbar"}, "for bodies that move")])
def test_methods_of_moving_bodies(core, change, said):
    experiment = core.experiment(1, change, drop=("elastic", "expansion", "heating"))
    with pytest.raises(SceneError, match=said):
        rigid_bodies(experiment)
