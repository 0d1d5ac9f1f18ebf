"""Joined topics: which message a translation is given, and what is dropped."""

from dataclasses import dataclass

import pytest

from jausml.runtime.bridge.connections.joins import Join
from jausml.runtime.bridge.connections.to_jaus import TopicsToMessage
from jausml.runtime.bridge.ends.topics import Topic
from jausml.runtime.messages import QueryTime, ReportTime, SetTime

from .bridge_support import PEER, Number, Serialized, peer_component, report, values


@dataclass
class Angle(Serialized):
    """The joined ROS message."""

    TYPE = "test_msgs/msg/Angle"

    yaw: float = 0.0


def number_and_angle(source, angle=None):
    """Minutes are the number; the hour is the angle, or 0 without a fresh one."""
    hour = 0 if angle is None else int(angle.yaw)
    return ReportTime(time_stamp=ReportTime.TimeStamp(minutes=int(source.data), hour=hour))


def pose(join, **options):
    return report("pose", number_and_angle, joins=[join], **options)


def angle_join(**options):
    return Join("angle", Angle, [Topic("angles")], freshness=0.5, **options)


def present(setting):
    report = setting.bridge.shared_messages.report(QueryTime, ReportTime).value
    stamp = ReportTime.decode(report).time_stamp
    return stamp.minutes, stamp.hour


def test_freshness_ends_when_it_says(world, setting):
    setting.open(pose(angle_join()))
    setting.ros.deliver["angles"](Angle(7.0))
    world.run(0.49)
    setting.say(1.0)
    assert present(setting) == (1, 7)
    world.run(0.02)
    setting.say(2.0)
    assert present(setting) == (2, 0)
    setting.ros.deliver["angles"](Angle(8.0))
    setting.say(3.0)
    assert present(setting) == (3, 8)


def test_what_came_before_the_bridge_was_closed_is_not_fresh(world, setting):
    connection = setting.open(pose(angle_join()))
    setting.ros.deliver["angles"](Angle(7.0))
    setting.bridge.close()
    setting.ros.made.clear()
    setting.bridge.open(setting.ros, world)
    setting.say(1.0)
    assert present(setting) == (1, 0)
    assert setting.drops(connection) == {}


def test_what_needs_a_fresh_message_is_dropped_and_counted(setting):
    connection = setting.open(pose(angle_join(drop=True)))
    setting.say(1.0)
    assert setting.bridge.shared_messages.report(QueryTime, ReportTime).value is None
    setting.ros.deliver["angles"](Angle(9.0))
    setting.say(2.0, every=0.6)
    setting.say(3.0)
    assert present(setting) == (2, 9)
    assert setting.drops(connection) == {"stale_join_angle": 2}
    counters = setting.bridge.component.counters.drops()
    assert counters["bridge.pose.stale_join_angle"] == 2


def test_a_message_that_lacks_its_join_does_not_end_silence(world, setting):
    peer_component(world)
    connection = TopicsToMessage(
        "drive",
        lambda _source, angle: SetTime() if angle else None,
        message=SetTime,
        type=Number,
        topics=[Topic("numbers")],
        joins=[angle_join(drop=True)],
        peers=[PEER],
        silence_timeout=1.0,
        safe_value=SetTime,
    )
    setting.open(connection)
    setting.say(*[1.0] * 15, every=0.1)
    assert connection.is_silent
    assert connection.statistics.safe_values == 1
    setting.ros.deliver["angles"](Angle())
    setting.say(1.0)
    assert not connection.is_silent


def test_joined_topics_are_heard_before_the_main_one(setting):
    """So that a latched message is there when the first main message comes."""
    setting.open(pose(angle_join()))
    assert setting.ros.made == [("subscription", "angles"), ("subscription", "numbers")]


def test_several_joins_and_topics(setting):
    found = []

    def translate(source, **joined):
        found.append(
            (source.data, {name: message and message.yaw for name, message in joined.items()})
        )

    joins = [Join("front", Angle, [Topic("a"), Topic("b")]), Join("rear", Angle, [Topic("c")])]
    setting.open(report("pose", translate, joins=joins))
    setting.ros.deliver["a"](Angle(1.0))
    setting.ros.deliver["b"](Angle(2.0))
    setting.say(4.0)
    assert found == [(4.0, {"front": 2.0, "rear": None})]


def test_connections_share_the_subscription_of_a_joined_topic(setting):
    found = []

    def connection(name):
        translate = lambda _source, angle: found.append((name, angle.yaw))  # noqa: E731
        return report(name, translate, joins=[angle_join()])

    setting.open(connection("one"), connection("two"))
    setting.ros.deliver["angles"](Angle(6.0))
    setting.say(0)
    assert found == [("one", 6.0), ("two", 6.0)]
    assert len(setting.ros.made) == 2


def test_diagnostics_show_the_age_of_joined_topics(world, setting):
    setting.open(pose(angle_join()))
    world.run(1.01)
    status = setting.ros.statuses[-1]["pose"]
    assert values(status)["join angle age (s)"] == "never"
    assert status.message == "no message yet"
    setting.say(0, every=1.0)
    assert setting.judged("pose") == ("warning", "nothing fresh from angle")
    world.run(0.75)
    setting.ros.deliver["angles"](Angle())
    world.run(0.25)
    status = setting.ros.statuses[-1]["pose"]
    assert float(values(status)["join angle age (s)"]) == pytest.approx(0.25, abs=0.02)
    assert (status.level, status.message) == ("ok", "running")
