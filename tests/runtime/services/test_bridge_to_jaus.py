"""Connections of bridges that carry ROS topics to JAUS."""

import pytest

from jausml.runtime import Guard
from jausml.runtime.bridge.ends.topics import Topic
from jausml.runtime.bridge.messages.limits import AbsentFieldError
from jausml.runtime.messages import QueryTime, ReportTime, Resume, SetTime
from jausml.runtime.transports.packets.packet import Priority

from .bridge_support import CORE, OTHER, OWN, PEER, Number, command, minutes, report, safe


def test_one_translation_serves_every_peer(world, setting):
    encoded = []

    class Counted(SetTime):
        def encode(self):
            encoded.append(self)
            return super().encode()

    def translate(source):
        return Counted(time_stamp=SetTime.TimeStamp(minutes=int(source.data)))

    peers = [world.probe(str(PEER)), world.probe(str(OTHER))]
    connection = setting.open(command(translate=translate, peers=[PEER, OTHER]))
    setting.say(5.0)
    assert [peer.take() for peer in peers] == [[minutes(5)], [minutes(5)]]
    assert len(encoded) == 1
    assert setting.ros.made == [("subscription", "numbers")]
    assert connection.statistics.passed == 1


def test_priority_and_acknowledgement(world, setting):
    sent = []
    send = world.send

    def spy(source, destination, payload, **options):
        sent.append((int.from_bytes(payload[:2], "little"), options))
        send(source, destination, payload, **options)

    world.send = spy
    setting.open(command(priority=Priority.SAFETY_CRITICAL, acknowledge=True))
    setting.say(5.0)
    options = dict(sent)[SetTime.CODE]
    assert options == {"priority": Priority.SAFETY_CRITICAL, "acknowledge": True}


def test_command_waits_for_ready(world, setting):
    connection = setting.open(command(control=Guard.READY))
    setting.say(1.0)
    assert setting.drops(connection) == {"not_ready": 1}
    received = []
    tested = world.component(str(PEER), services=CORE)
    tested.handle(SetTime, lambda message, _: received.append(message), when=Guard.READY)
    tested.start()
    world.run(10.0)
    setting.say(2.0, every=0)
    assert received == [minutes(2)]
    assert setting.drops(connection) == {"not_ready": 1}


def test_controlled_is_enough_where_nobody_can_resume(world, setting):
    services = tuple(s for s in CORE if "Management" not in s.urn)
    received = []
    tested = world.component(str(PEER), services=services)
    tested.handle(SetTime, lambda message, _: received.append(message), when=Guard.CONTROLLED)
    tested.start()
    setting.open(command(control=Guard.CONTROLLED))
    world.run(2.0)
    setting.say(2.0, every=0)
    assert received == [minutes(2)]
    assert world.count(Resume.CODE) == 0


def test_report_is_served_to_queries_and_events(world, setting):
    setting.open(report(), services=CORE)
    watched = []
    client = world.started("7.1.1", services=())
    client.subscribe(
        OWN, QueryTime(presence_vector=1), ReportTime, lambda answer, _: watched.append(answer)
    )
    probe = world.probe("8.1.1")
    assert probe.ask(QueryTime(presence_vector=1), OWN) == []  # nothing yet
    world.run(1.0)
    setting.say(3.0)
    (answer,) = probe.ask(QueryTime(presence_vector=1), OWN)
    assert answer.time_stamp.minutes == 3
    setting.say(4.0, every=1.0)
    assert [watched_report.time_stamp.minutes for watched_report in watched] == [3, 4]


def test_connections_may_feed_one_report(world, setting):
    feeds = (report(name, topics=[Topic(name)]) for name in "ab")
    setting.open(*feeds, services=CORE)
    probe = world.probe("8.1.1")
    for topic, value in (("a", 1.0), ("b", 2.0), ("a", 3.0)):
        setting.ros.deliver[topic](Number(value))
        (answer,) = probe.ask(QueryTime(presence_vector=1), OWN)
        assert answer.time_stamp.minutes == value


def joints_served(setting, **options):
    """Opens a report of the joints left and right, as seconds and minutes.

    A number names them by its hundreds: left by 1, right by 2, both by 3, another joint by 4.
    """
    names = {1: ["left"], 2: ["right"], 3: ["right", "left"], 4: ["wheel"]}

    def translate(source):
        keys, value = names[source.data // 100], int(source.data) % 100
        left, right = joints.by_name(("left", "right"), keys, [value] * len(keys), "position")
        return ReportTime(time_stamp=ReportTime.TimeStamp(seconds=left, minutes=right))

    joints = report("joints", translate, **options)
    return setting.open(joints, services=CORE)


def asking(world):
    """Returns what asks for both joints; there are none where there is no report."""
    probe = world.probe("8.1.1")

    def ask():
        reports = probe.ask(QueryTime(presence_vector=1), OWN)
        return [(report.time_stamp.seconds, report.time_stamp.minutes) for report in reports]

    return ask


def test_a_report_has_the_newest_value_of_each_name_whoever_said_it(world, setting):
    connection, ask = joints_served(setting, freshness=1.0), asking(world)
    say = setting.ros.deliver["numbers"]
    say(Number(105))
    assert ask() == []
    assert connection.statistics.failures == {
        "absent_field": "position: 'right' is not among the names"
    }
    say(Number(206))
    assert ask() == [(5, 6)]
    say(Number(107))
    assert ask() == [(7, 6)]
    say(Number(308))
    assert ask() == [(8, 8)]


def test_such_a_report_is_as_old_as_its_oldest_value(world, setting):
    joints_served(setting, freshness=1.0)
    ask = asking(world)
    say = setting.ros.deliver["numbers"]
    say(Number(105))
    for _ in range(9):
        world.run(0.1)
        say(Number(206))
    assert ask() == [(5, 6)]
    world.run(0.2)  # the right one is fresh, the left one is not
    assert ask() == []
    say(Number(206))
    assert ask() == []
    say(Number(107))
    assert ask() == [(7, 6)]


def test_the_age_of_what_was_not_reported_is_not_that_of_the_next_report(world, setting):
    joints_served(setting, freshness=1.0)
    ask = asking(world)
    say = setting.ros.deliver["numbers"]
    say(Number(105))
    say(Number(280))  # more than there is room for in the report
    assert ask() == []
    world.run(0.9)
    say(Number(308))
    world.run(0.5)
    assert ask() == [(8, 8)]


def test_a_translation_that_is_tried_knows_nothing_of_messages_before():
    joints = report("joints", lambda _: None, topics=[])
    for key in ("left", "right"):
        with pytest.raises(AbsentFieldError):
            joints.by_name(("left", "right"), [key], [1.0], "position")


# ------------------------------------------------------------------ who gets what, and when


def obeying_peer(world, address, received):
    """A component that obeys in Ready, and keeps what it is told."""
    tested = world.component(str(address), services=CORE)
    take = lambda message, _: received.append((address, message.time_stamp.minutes))  # noqa: E731
    tested.handle(SetTime, take, when=Guard.READY)
    tested.start()
    return tested


def test_peers_get_messages_while_they_obey(world, setting):
    """One that does not obey costs the others nothing, and has its messages again afterwards."""
    received = []
    other = obeying_peer(world, OTHER, received)
    connection = setting.open(command(control=Guard.READY, peers=[PEER, OTHER]))
    world.run(5.0)
    setting.say(1.0, every=0)
    assert received == [(OTHER, 1)]
    assert setting.drops(connection) == {}
    assert connection.statistics.withheld == {PEER: 1}
    assert ("withheld from 1.1.1", 1) in connection.close_account()
    peer = obeying_peer(world, PEER, received)
    world.run(10.0)
    setting.say(2.0, every=0)
    assert sorted(received[1:]) == [(PEER, 2), (OTHER, 2)]
    other.stop()
    world.run(1.0)
    setting.say(3.0, every=0)
    assert received[3:] == [(PEER, 3)]
    assert connection.statistics.withheld == {PEER: 1, OTHER: 1}
    assert connection.statistics.passed == 3
    peer.stop()


def test_a_translation_that_halts_the_bridge_has_the_stop_as_its_last_word(world, setting):
    peer = world.probe(str(PEER))

    def translate(source):
        if source.data == 9.0:
            setting.bridge.component.fail("the translation says so")
        return minutes(int(source.data))

    connection = setting.open(command(translate=translate, is_command=True, safe_value=safe))
    setting.say(5.0, 6.0, 9.0, 7.0)
    assert peer.take() == [minutes(0), minutes(5), minutes(6), minutes(0)]
    assert setting.drops(connection) == {"not_ready": 2}
