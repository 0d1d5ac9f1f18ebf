"""The forms of a translation: on light classes, and on the message classes of ROS."""

import logging

import pytest

from jausml.runtime import ros_classes
from jausml.runtime.bridge.connections.joins import Join
from jausml.runtime.bridge.ends.topics import Topic
from jausml.runtime.bridge.messages.limits import AbsentFieldError
from jausml.runtime.conversions import ConversionError
from jausml.runtime.messages import SetTime
from jausml.runtime.wire.message import DecodeError, EncodeError

from .bridge_support import (
    NAN,
    OWN,
    PEER,
    Number,
    RosNumber,
    Serialized,
    command,
    event,
    message_connection,
    minutes,
    number_to_time,
    peer_component,
    safe,
    values,
)

_LIMIT = 59


class Generated:
    """What a generated base has."""

    def translate_numbers(self, source, other=None):
        if source.data == -1.0:
            return None
        if source.data == -2.0:
            raise ConversionError("no time")
        number = self.drive.clamp.integer("minutes", source.data, 0, _LIMIT)
        hour = 0 if other is None else int(other.data)
        return SetTime(time_stamp=SetTime.TimeStamp(minutes=number, hour=hour))

    def __init__(self, **options):
        self.drive = command(translate=self.translate_numbers, **options)


class Overridden(Generated):
    """What a user makes of it."""

    given = None

    def translate_numbers(self, source, other=None):
        self.given = source
        return super().translate_numbers(source, other)


class OnRosClasses(Overridden):
    """What a user makes of it who needs the classes of ROS."""

    @ros_classes
    def translate_numbers(self, source, other=None):
        return super().translate_numbers(source, other)


FORMS = {Generated: "light classes", Overridden: "light classes", OnRosClasses: "ROS classes"}


def told(world, setting, name):
    world.run(1.1)
    return values(setting.ros.statuses[-1][name])


@pytest.mark.parametrize(("kind", "form"), FORMS.items())
def test_forms_pass_the_same_on_and_count_alike(world, setting, kind, form):
    peer = world.probe(str(PEER))
    made = kind()
    connection = setting.open(made.drive)
    setting.say(5.0, -1.0, -2.0, 70.0, NAN, 7.0)
    setting.ros.take["numbers"](b"\0\1\0\0")
    assert peer.take() == [minutes(5), minutes(59), minutes(7)]
    assert setting.drops(connection) == {
        "filtered": 1, "no_counterpart": 1, "out_of_range": 1, "not_decodable": 1,
    }  # fmt: skip
    counts = connection.statistics
    assert (counts.arrivals, counts.passed, counts.limited) == (7, 3, 1)
    assert counts.out_of_range == {("clamp", "minutes"): 1, ("not_clampable", "minutes"): 1}
    status = told(world, setting, "drive")
    assert status["translation"] == form
    assert status.get("override") == (None if kind is Generated else "translate_numbers")


@pytest.mark.parametrize("kind", FORMS)
def test_forms_do_the_same_in_silence(world, setting, kind):
    peer = world.probe(str(PEER))
    connection = setting.open(kind(silence_timeout=1.0, safe_value=safe, is_command=True).drive)
    assert peer.take() == [minutes(0)]
    setting.say(5.0)
    assert not connection.is_silent
    setting.say(6.0, every=1.1)
    assert peer.take() == [minutes(5), minutes(6), minutes(0)]
    assert connection.is_silent


@pytest.mark.parametrize(("kind", "given"), [(Overridden, Number), (OnRosClasses, RosNumber)])
def test_overrides_are_given_the_classes_they_ask_for(setting, kind, given):
    made = kind()
    setting.open(made.drive)
    setting.say(3.0)
    assert made.given == given(3.0)


class CountedNumber(Serialized):
    """A light class that counts how often a message is read."""

    read = 0

    def __init__(self, data):
        self.data = data
        type(self).read += 1


@pytest.mark.parametrize("kind", FORMS)
def test_joins_are_objects_in_every_form_and_made_once(world, setting, kind):
    CountedNumber.read = 0
    peer = world.probe(str(PEER))
    setting.open(kind(joins=[Join("other", CountedNumber, [Topic("others")])]).drive)
    for value in (1.0, 2.0, 3.0):
        setting.ros.take["others"](Number(value).to_cdr())
    setting.say(11.0, 12.0)
    assert peer.take() == [
        SetTime(time_stamp=SetTime.TimeStamp(minutes=value, hour=3)) for value in (11, 12)
    ]
    assert CountedNumber.read == (0 if kind is OnRosClasses else 1)


def test_joined_message_that_cannot_be_read_is_counted(setting):
    connection = setting.open(Generated(joins=[Join("other", Number, [Topic("others")])]).drive)
    setting.ros.take["others"](b"\0")
    setting.say(1.0)
    assert setting.drops(connection) == {"not_decodable": 1}


# ------------------------------------------------------------------ JAUS to ROS


@ros_classes
def real_minutes(report):
    return RosNumber(float(report.timeout))


def test_a_bridge_may_mix_forms(world, setting, caplog):
    peer_component(world, event_timeout=3)
    with caplog.at_level(logging.INFO, "jausml"):
        setting.open(
            event("light", rate=10.0),
            event("real", rate=10.0, translate=real_minutes),
            Generated().drive,
        )
    world.run(1.1)
    for name, form in (("light", "light classes"), ("real", "ROS classes")):
        assert set(setting.ros.numbers(name)) == {3.0}
        assert told(world, setting, name)["translation"] == form
    assert len({len(setting.ros.numbers(name)) for name in ("light", "real")}) == 1
    assert [
        record.getMessage() for record in caplog.records if "translation" in record.message
    ] == ["translations on ROS classes: real"]


def test_hand_written_connections_may_have_types_of_ros(world, setting):
    peer_component(world, event_timeout=3)
    given = []

    def translate(source):
        given.append(source)
        return number_to_time(source)

    drive, timeout = command(translate=translate), event(rate=10.0, translate=real_minutes)
    drive._type = timeout._type = RosNumber
    setting.open(drive, timeout)
    setting.say(4.0, every=1.0)
    assert given == [RosNumber(4.0)]
    assert set(setting.ros.numbers("timeout")) == {3.0}


def test_what_is_no_ros_message_is_not_published(world, setting):
    peer_component(world)
    connection = setting.open(event(rate=10.0, translate=lambda _report: SetTime()))
    world.run(0.5)
    assert setting.drops(connection)["translation_failed"] >= 4
    assert setting.ros.numbers("timeout") == []


def test_message_that_cannot_be_read_is_counted(world, setting):
    connection = setting.open(message_connection())
    operator = world.probe("5.1.1")
    operator.send_bytes(SetTime.CODE.to_bytes(2, "little"), OWN)
    operator.tell(OWN, minutes(7))
    assert setting.ros.numbers("times") == [7.0]
    assert setting.drops(connection) == {"not_decodable": 1}


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (AbsentFieldError("X"), "absent_field"),
        (ConversionError("no length"), "no_counterpart"),
        (EncodeError("x", "too long"), "not_encodable"),
        (DecodeError("x", "too short"), "not_decodable"),
        (ZeroDivisionError(), "translation_failed"),
    ],
)
def test_every_drop_has_a_name(world, setting, error, reason):
    def translate(_report):
        raise error

    peer_component(world)
    connection = setting.open(event(rate=10.0, translate=translate))
    world.run(0.5)
    assert list(setting.drops(connection)) == [reason]
    assert connection.statistics.arrivals == setting.drops(connection)[reason]
    assert connection.statistics.last_arrival is not None
