"""Path segments of JAUS become the path of a ROS action: real processes, a real action server."""

import needs
import pytest

needs.ask("rclpy")

from jausml.runtime.services.list_manager import chain

from ..bridge_support import wait_for
from .list_system import OPERATOR, PATIENCE, ROBOT, facts, pass_by, wait_goal

pytestmark = [pytest.mark.slow, pytest.mark.live]


def segments(operator, *xs, factor=0.0):
    """Returns segments that end at these x, one after the other, drawn to y = 1 by the factor."""
    segment = operator.messages.SetLocalPathSegment
    made = [
        segment(p1_x=x - 0.5, p1_y=1.0, p2_x=float(x), p2_y=0.0, weighting_factor=factor)
        for x in xs
    ]
    return chain([(uid, path_segment.encode(), 0) for uid, path_segment in enumerate(made, 1)])


def execute(operator):
    """Sends ExecuteList; command events are of a newer core than that of path segment drivers."""
    message = operator.messages.ExecuteList(speed=1.0, element_uid=0)
    operator.send(message, ROBOT, acknowledge=True)


def test_segments_are_followed_and_a_curve_is_refused(system, tracker_operator):
    operator = tracker_operator
    straight, bent = segments(operator, 2, 5), segments(operator, 2, 5, factor=0.5)
    mixed = chain([(segment.uid, segment.data, 0) for segment in (straight[0], bent[1])])
    assert not operator.set(mixed)
    assert operator.refusals == [4]
    assert not facts(system, "goal")
    log = system.log_of("tracker")
    assert "bridge.follow.no_counterpart (1 times): 0.50" in log
    assert f"list_manager.rejected (1 times): request of {OPERATOR}: element 2" in log
    # The distance tells which segment is followed.
    assert operator.set(segments(operator, 2, 5, 9))
    execute(operator)
    goal = wait_goal(system)
    assert (goal["x"], goal["frame"]) == ([2.0, 5.0, 9.0], "odom")
    operator.wait_active(1)
    pass_by(system, operator, 2, 3)
    assert operator.seen == [0, 1, 2, 3, 0]
    # The robot stops when its operator lets go.
    execute(operator)
    wait_goal(system, 2)
    operator.wait_active(1)
    operator.session.release()
    wait_for(lambda: facts(system, "canceled"), "the cancellation", PATIENCE)
