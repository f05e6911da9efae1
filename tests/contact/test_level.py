"""Level pieces of a face over the same nodes act on a wall as one, and what a contact needs of the particles near it is kept while little moves."""

import numpy as np
import pytest
from contact_scenes import count as directions_of
from contact_scenes import dropped

from mpm.boundary import extents
from mpm.config import load
from mpm.contact.find import find_all, list_near
from mpm.contact.found import FLAT, NEAR
from mpm.contact.skin import lay_skins, new_skin
from mpm.contact.solve import pose
from mpm.contact.sums import LAG, add_up, hold_good, make_room, new_sums
from mpm.contact.weights import weigh
from mpm.scene.build import build
from mpm.state import PAD

pytestmark = pytest.mark.plain


def found_at_the_floor(dimension, tilt=0.0):
    """(scene, skin, contacts, how many, contacts without company, how many) of a block on the floor; its pieces lower by `tilt` sideways."""
    scene = build(load(dropped(dimension, 0.0, 0.3, cells=2)))
    touching, D = scene.meeting.touching, directions_of(dimension)
    skin = new_skin(D, touching.first)
    lay_skins(scene.space, scene.for_motion, skin, skin.every, skin.first)
    skin.x[:, -1] -= tilt * skin.x[:, :-1] @ np.array([1.0, 1.7])[: D - 1]
    common = scene.space, scene.for_motion, skin, touching.stops, touching.pairs, touching.tools, touching.room, NEAR
    alone, each = find_all(*common, touching.number[:0])
    assert (alone.mates[:each] == -1).all()
    return (scene, skin, *find_all(*common, touching.number), alone, each)


def company(contacts, i):
    """The pieces of contact i."""
    pieces, s = [contacts.piece[i]], contacts.mates[i]
    while s >= 0:
        pieces.append(s)
        s = contacts.after[s]
    return [int(s) for s in pieces]


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_each_piece_is_in_one_contact(dimension, tilt):
    scene, skin, contacts, count, alone, each = found_at_the_floor(dimension, tilt)
    groups = [company(contacts, i) for i in range(count)]
    assert sorted(s for pieces in groups for s in pieces) == sorted(int(s) for s in alone.piece[:each]) and (scene.meeting.touching.number == -1).all()
    assert (count < each) == (tilt == 0.0)  # a tenth of a cell from one cell to the next is not flat
    for i, pieces in enumerate(groups):
        area = skin.area[pieces]
        assert contacts.gap[i] == skin.x[pieces, -1].min() and np.ptp(skin.x[pieces, -1]) <= 2 * FLAT * scene.space.h
        if len(pieces) > 1:
            assert contacts.point[i, 0] == pytest.approx(area @ skin.x[pieces] / area.sum(), rel=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_weights_of_several_are_linear_exact_and_kept(dimension):
    """sum W = 1 and sum W x_i = x_s of the mean place; sums that are a little late change W by as little, and no more than LAG of a cell is allowed."""
    scene, skin, contacts, count, _, _ = found_at_the_floor(dimension)
    touching, space, D = scene.meeting.touching, scene.space, directions_of(dimension)
    nodes = np.zeros((1, np.prod(extents(space)), D + 1))
    nodes[..., D] = 1.0
    args = space, touching.walls, touching.fields
    sums = make_room(*args, new_sums(space, 1), contacts, count, touching.number)
    add_up(space, scene.gradient, scene.for_motion, touching.walls, touching.fields, skin, sums, touching.number)
    problem = pose(space, touching.walls, touching.fields, contacts, count, nodes, touching.tools, touching.number)
    weigh(space, scene.gradient, touching.walls, touching.fields, skin, sums, problem, touching.number)
    places = (np.stack(np.unravel_index(problem.place[problem.at[:, 0]], extents(space)[:D]), axis=-1) - PAD) * space.h
    W = problem.coef[:, 0, :, 0]
    assert problem.bear[:, :D] == pytest.approx(np.repeat((W**2).sum(axis=1)[:, None], D, axis=1), rel=1e-12)
    assert W.sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert np.einsum("im,ima->ia", W, places) == pytest.approx(contacts.point[:count, 0], abs=1e-12)
    assert hold_good(*args, sums, contacts, count, touching.number)
    sums.moved[0] = 1.01 * LAG * space.h
    assert not hold_good(*args, sums, contacts, count, touching.number)
    sums.moved[0] = 0.0
    sums.first[1] -= 1
    assert not hold_good(*args, sums, contacts, count, touching.number) and (touching.number == -1).all()


def test_a_list_of_what_is_near_misses_nothing():
    """Pieces that are not listed are farther off than contacts are looked for, by what may still move."""
    scene, skin, contacts, count, _, _ = found_at_the_floor(3)
    touching, everything = scene.meeting.touching, {company(contacts, i)[0] for i in range(count)}
    list_near(scene.space, scene.for_motion, skin, touching.stops, True)
    near = set(skin.near[: skin.starts[-1]].tolist())
    assert everything <= near and len(near) < len(skin.area) and skin.left[0] > 0.0
    rest = [s for s in range(len(skin.area)) if s not in near]
    assert (skin.x[rest, -1] > (NEAR + 0.1) * scene.space.h).all()
    list_near(scene.space, scene.for_motion, skin, touching.stops, False)
    assert skin.starts[-1] == len(skin.area)
