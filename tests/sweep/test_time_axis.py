import numpy as np

from mpm.sweep.time_axis import axis, places


def test_equal_times_stay_bitwise():
    t = np.arange(5) * 0.1
    assert axis([t, t.copy()], [True, True]).tobytes() == t.tobytes()


def test_union_of_cadences_and_round_off_is_one_time():
    union = axis([np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.5, 1.0 + 1e-13])], [True, True])
    np.testing.assert_allclose(union, [0, 0.5, 1, 2], atol=1e-12)


def test_a_point_that_stopped_fills_the_front_and_its_odd_sample_is_left_out():
    onto = axis([np.arange(4.0), np.array([0.0, 1.0, 1.37])], [True, False])
    samples, where = places(np.array([0.0, 1.0, 1.37]), onto)
    assert onto.tolist() == [0, 1, 2, 3] and samples.tolist() == [0, 1] and where.tolist() == [0, 1]


def test_nobody_ok_takes_the_longest_and_nothing_is_nothing():
    assert axis([np.array([0.0, 1.0]), np.array([0.0, 1.0, 1.5])], [False, False]).tolist() == [0, 1, 1.5]
    assert len(axis([np.zeros(0)], [True])) == 0
    assert [len(part) for part in places(np.zeros(0), np.arange(3.0))] == [0, 0]
    assert [part.tolist() for part in places(np.array([0.0]), np.array([0.0]))] == [[0], [0]]
