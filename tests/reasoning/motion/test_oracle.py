from __future__ import annotations

from reasoning.motion.layout import Layout
from reasoning.motion.oracle import Oracle
from reasoning.motion.trajectory import shortest

ROOM = Layout(8, 8, (((3.0, 0.0), (5.0, 0.0), (5.0, 4.0), (3.0, 4.0)),), ((6.0, 6.0, 0.1),))


def test_questions_are_counted_and_layouts_built_once() -> None:
    oracle = Oracle()
    assert oracle.free(ROOM, 0.25, (1, 1))
    assert oracle.path_exists(ROOM, 0.25, (1, 1), (7, 1))
    assert not oracle.path_exists(ROOM, 0.25, (1, 1), (4, 1))
    assert oracle.blockers(ROOM, 0.25, (1, 1), (6, 6.1)) == {0}
    assert oracle.shortest(ROOM, 0.25, (1, 1), (7, 1)) == shortest(ROOM, 0.25, (1, 1), (7, 1))
    assert (oracle.counts.queries, oracle.counts.trajectories, oracle.counts.layouts) == (4, 1, 1)
    oracle.path_exists(ROOM, 0.3, (1, 1), (7, 1))
    oracle.path_exists(ROOM.bare, 0.25, (1, 1), (7, 1))
    assert oracle.counts.layouts == 3


def test_times_are_rounded_up_and_at_least_one() -> None:
    oracle = Oracle()
    room = Layout(10, 4)
    assert oracle.time_estimate(room, 0.25, (1, 1), (1, 1), 3) == 1
    assert oracle.time_estimate(room, 0.25, (1, 1), (4, 1), 3) == 1
    assert oracle.time_estimate(room, 0.25, (1, 1), (4.1, 1), 3) == 2
    assert oracle.time_estimate(room, 0.25, (1, 1), (9.5, 3), 3) == 3
    assert oracle.time_estimate(room, 0.25, (1, 1), (11, 1), 3) is None
