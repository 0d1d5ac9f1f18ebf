"""Parameters and faults of topics of bridges in a small world, without ROS."""

import logging

import pytest

from jausml.runtime import AttributeParameter, Join
from jausml.runtime.bridge.bridge import Bridge
from jausml.runtime.bridge.ends import parameters
from jausml.runtime.bridge.ends.ends import BridgeSettings
from jausml.runtime.bridge.ends.topics import Qos, Topic, TopicFault, nearest
from jausml.runtime.messages import QueryEventTimeout

from .bridge_support import (
    OTHER,
    OWN,
    PEER,
    Number,
    Ros,
    command,
    event,
    minutes,
    number_to_time,
    peer_component,
    query,
    safe,
    values,
)

# ------------------------------------------------------------------ what the ends are


def test_topics_and_peers_are_parameters(world, setting):
    peer_component(world, OTHER, event_timeout=3)
    setting.ros.parameters |= {
        "timeout.topics": ["c", "/d"],
        "timeout.peers": [str(OTHER)],
        "drive.topic": "other_numbers",
    }
    setting.open(event(rate=10.0, topics=[Topic("a"), Topic("b")]), command())
    world.run(1.0)
    assert setting.ros.made[:2] == [("publisher", "c"), ("publisher", "/d")]
    assert set(setting.ros.numbers("c")) == {3.0}
    assert setting.ros.numbers("c") == setting.ros.numbers("/d")
    assert len(setting.ros.numbers("c")) >= 9
    assert list(setting.ros.deliver) == ["other_numbers"]
    assert setting.ros.changed["timeout.topics"] is None


def test_parameters_of_topics_and_peers_are_checked(setting):
    asked = {}

    class Asked(Ros):
        def parameter(self, parameter, changed=None):
            asked[parameter.name] = parameter
            return super().parameter(parameter, changed)

    setting.ros = Asked()
    setting.open(event(rate=10.0, topics=[Topic("a"), Topic("b")]))
    with pytest.raises(ValueError, match="timeout has 2 topics, not 1"):
        asked["timeout.topics"].check(["a"])
    with pytest.raises(ValueError, match=r"1\.1\.255 does not name one component"):
        asked["timeout.peers"].check(["1.1.255"])
    # Each report would be published twice.
    with pytest.raises(ValueError, match=r"^1\.1\.2 is there twice"):
        asked["timeout.peers"].check(["1.1.2", "1.1.2"])
    with pytest.raises(ValueError, match=r"^a is there twice"):
        asked["timeout.topics"].check(["a", "a"])
    assert asked["timeout.peers"].default == [str(PEER)]


def test_two_ways_to_name_a_topic_make_two_subscriptions(setting):
    quick = Topic("numbers", Qos(reliability="best_effort"))
    second = command("second")
    third = command("third")
    third._topics = (quick,)
    setting.open(command(), second, third)
    assert setting.ros.made == [("subscription", "numbers"), ("subscription", "numbers")]


def test_joins_have_parameters(setting):
    join = Join("other", Number, [Topic("others")], freshness=1.0)
    setting.ros.parameters["drive.other.topic"] = "renamed"
    seen = []

    def translate(source, other=None):
        seen.append(other)
        return number_to_time(source)

    setting.open(command(joins=[join], translate=translate))
    deliver = setting.ros.deliver
    deliver["renamed"](Number(2.0))
    deliver["numbers"](Number(1.0))
    setting.ros.changed["drive.other.freshness"](0.5)
    setting.world.run(0.6)
    deliver["numbers"](Number(1.0))
    assert seen == [Number(2.0), None]


# ------------------------------------------------------------------ changes while it runs


@pytest.mark.parametrize(
    ("of", "least", "state"), [(event, 30, "confirmed"), (query, 18, "source")]
)
def test_rate_changes_while_the_bridge_runs(world, setting, of, least, state):
    peer_component(world, event_timeout=4)
    connection = setting.open(of(rate=1.0))
    world.run(2.0)
    before = len(setting.ros.numbers("timeout"))
    setting.ros.changed["timeout.rate"](20.0)
    world.run(2.0)
    assert before <= 4
    assert len(setting.ros.numbers("timeout")) - before >= least
    setting.ros.changed["timeout.rate"](2.0)
    world.run(0.5)
    before = len(setting.ros.numbers("timeout"))
    world.run(2.0)
    assert 3 <= len(setting.ros.numbers("timeout")) - before <= 6
    assert connection.declared_rate == 2.0
    assert connection.describe_peers() == [("peer 1.1.1", state)]


@pytest.mark.parametrize("of", [event, query])
@pytest.mark.parametrize(
    ("stated", "given", "rate"),
    [
        (0.0, {}, 1.0),
        (0.0, {"frequency": 20.0}, 20.0),
        (0.0, {"frequency": 20.0, "timeout.rate": 5.0}, 5.0),
        (1.0, {"frequency": 20.0}, 1.0),
        (10.0, {"timeout.rate": 2.0}, 2.0),
    ],
)
def test_who_states_no_rate_follows_the_frequency_of_the_bridge(
    world, setting, of, stated, given, rate
):
    """The paper gives a bridge its frequency when it is started."""
    peer_component(world, event_timeout=4)
    setting.ros.parameters |= given
    connection = setting.open(of(rate=stated))
    world.run(3.0)
    assert connection.rate == connection.declared_rate == rate
    assert abs(len(setting.ros.numbers("timeout")) - 3 * rate) <= 2
    assert set(setting.ros.numbers("timeout")) == {4.0}
    assert of is event or abs(world.count(QueryEventTimeout.CODE) - 3 * rate) <= 1


def test_silence_timeout_changes_while_the_bridge_runs(world, setting):
    peer = world.probe(str(PEER))
    setting.open(command(silence_timeout=10.0, safe_value=safe))
    world.run(5.0)
    setting.ros.changed["drive.silence_timeout"](1.0)
    world.run(0.9)
    assert peer.take() == []
    world.run(0.2)
    assert peer.take() == [minutes(0)]
    setting.ros.changed["drive.silence_timeout"](0.0)
    setting.say(7.0, every=5.0)
    assert peer.take() == [minutes(7)]


def test_attributes_follow_their_parameters(setting):
    bridge = setting.bridge = Bridge(BridgeSettings("bridge", OWN))
    bridge.reach, bridge.frame = 8.0, "odom"
    bridge.parameters = [
        AttributeParameter("reach", "reach", "Reach (m)."),
        AttributeParameter("pose.frame_id", "frame", "Frame."),
    ]
    setting.ros.parameters["pose.frame_id"] = "map"
    bridge.open(setting.ros, setting.world)
    assert (bridge.reach, bridge.frame) == (8.0, "map")
    setting.ros.changed["reach"](9.0)
    assert bridge.reach == 9.0


@pytest.mark.parametrize(
    ("name", "expected"), [("drive.rat", "drive.rate"), ("Drive_rate", "drive.rate"), ("q", "")]
)
def test_nearest_name(name, expected):
    assert nearest(name, ["drive.rate", "jaus_port"]) == expected


# ------------------------------------------------------------------ faults of topics


def test_faults_of_topics_are_in_diagnostics_and_once_in_the_log(world, setting, caplog):
    fault = TopicFault("incompatible_qos", "nothing comes from /gps on /numbers")
    join = Join("other", Number, [Topic("others")])
    setting.open(command(joins=[join], translate=lambda source, **_: number_to_time(source)))
    with caplog.at_level(logging.WARNING, "jausml"):
        setting.ros.found_faults["numbers", False] = [fault]
        setting.ros.found_faults["others", False] = [TopicFault("deadline_missed", "late")]
        world.run(5.0)
    status = setting.ros.statuses[-1]["drive"]
    assert (status.level, status.message) == ("warning", fault.text)
    assert values(status)["incompatible qos"] == fault.text
    assert values(status)["deadline missed"] == "late"
    assert [record.getMessage() for record in caplog.records] == [
        f"bridge.drive.incompatible_qos (1 times): {fault.text}",
        "bridge.drive.deadline_missed (1 times): late",
    ]
    setting.ros.found_faults.clear()
    world.run(2.0)
    assert setting.ros.statuses[-1]["drive"].message == "no message yet"


def test_faults_of_publishers_are_in_diagnostics(world, setting):
    peer_component(world)
    setting.ros.found_faults["timeout", True] = [TopicFault("incompatible_qos", "nobody")]
    setting.open(event(rate=10.0))
    world.run(2.0)
    assert setting.ros.statuses[-1]["timeout"].message == "nobody"


def test_authority_and_events_have_the_ranges_of_their_octets():
    """RequestControl and Events have an octet for each (AS5710); no event at a time is none."""
    assert parameters.AUTHORITY.limits == (0, 255)
    assert parameters.MAX_EVENTS.limits == (1, 255)
