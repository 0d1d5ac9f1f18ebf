"""What connections of bridges drop, and values that their targets cannot carry."""

import itertools
import time

import pytest
from for_each import for_each

from jausml.runtime.bridge.messages.limits import (
    AbsentFieldError,
    Clamp,
    DropField,
    DropMessage,
    Error,
    OutOfRangeError,
)
from jausml.runtime.conversions import ConversionError
from jausml.runtime.messages import ReportTime, SetTime
from jausml.runtime.wire.message import EncodeError

from .bridge_support import (
    INFINITE,
    NAN,
    PEER,
    command,
    event,
    minutes,
    peer_component,
    raising,
    safe,
)


@pytest.mark.parametrize(
    ("translate", "reason"),
    [
        (lambda _source: None, "filtered"),
        (raising(AbsentFieldError("X")), "absent_field"),
        (raising(ConversionError("no length")), "no_counterpart"),
        (raising(EncodeError("x", "too long")), "not_encodable"),
        (raising(ZeroDivisionError()), "translation_failed"),
        (lambda _source: minutes(77), "not_encodable"),
    ],
)
def test_every_drop_has_a_name(world, setting, translate, reason):
    connection = setting.open(command(translate=translate))
    setting.say(1.0)
    assert setting.drops(connection) == {reason: 1}
    assert world.counters.snapshot()[f"bridge.drive.{reason}"] == 1
    assert connection.statistics.passed == 0
    assert world.count(SetTime.CODE) == 0


def test_a_translation_that_blocks_is_named(world, setting):
    """It stops the JAUS side too: both sides have one thread."""

    def dawdle(source):
        time.sleep(source.data)
        raise ConversionError("too late")

    connection = setting.open(command(translate=dawdle))
    setting.say(0.6, 0.0)
    assert setting.drops(connection) == {"no_counterpart": 2}
    assert world.counters.drops()["bridge.drive.blocked"] == 1


def test_middleware_that_refuses_does_not_end_the_loop(world, setting):
    peer_component(world)
    connection = setting.open(event(rate=10.0))
    setting.ros.fails = True
    world.run(0.5)
    setting.ros.fails = False
    world.run(0.5)
    assert setting.drops(connection).keys() == {"not_published"}
    assert setting.drops(connection)["not_published"] >= 4
    assert len(setting.ros.numbers("timeout")) >= 4


FITTING = [
    (lambda limit: limit("F", 2.0, -1.0, 2.0), 2.0),
    # A tyre angle of 0.5297 rad is full effort, but for the last bits of the factor.
    (lambda limit: limit("F", 0.5297 * 188.786105342647, -100.0, 100.0), 100.0),
    (lambda limit: limit("F", -1e-13, 0.0, 100.0), 0.0),
    (lambda limit: limit.integer("F", 2.6, 0, 3), 3),
    (lambda limit: limit.integer("F", 255.4, 0, 255), 255),
    (lambda limit: limit.integer("F", -1e-17, 0, 255), 0),
    (lambda limit: limit.integer("F", 2**64 - 1, 0, 2**64 - 1), 2**64 - 1),
    (lambda limit: limit.integer("F", -(2.0**63), -(2**63), 2**63 - 1), -(2**63)),
    (lambda limit: limit.listed("F", 4.2, ((0, 1), (4, 5))), 4),
    (lambda limit: limit.finite("F", 1e300), 1e300),
    (lambda limit: limit.single("F", 3e38), 3e38),
    (lambda limit: limit.text("F", "caf\xe9", 0, 4), "caf\xe9"),
    (lambda limit: limit.octets("F", b"abc", 3, 3), b"abc"),
]
# With the nearest legal value, None where nothing is nearest.
OUTSIDE = [
    (lambda limit: limit("F", 2.1, -1.0, 2.0), 2.0),
    (lambda limit: limit("F", 2.0000001, -1.0, 2.0), 2.0),
    (lambda limit: limit("F", 10**400, -1.0, 2.0), 2.0),
    (lambda limit: limit.integer("F", 255.5, 0, 255), 255),
    (lambda limit: limit.integer("F", 2.0**64, 0, 2**64 - 1), 2**64 - 1),
    (lambda limit: limit.integer("F", 10**400, 0, 255), 255),
    (lambda limit: limit.finite("F", -INFINITE), None),
    (lambda limit: limit("F", -INFINITE, -1.0, 2.0), -1.0),
    (lambda limit: limit("F", NAN, -1.0, 2.0), None),
    (lambda limit: limit.integer("F", INFINITE, 0, 255), 255),
    (lambda limit: limit.integer("F", -3.2, 0, 255), 0),
    (lambda limit: limit.integer("F", NAN, 0, 255), None),
    (lambda limit: limit.listed("F", 2, ((0, 1), (4, 5))), None),
    (lambda limit: limit.listed("F", NAN, ((0, 1),)), None),
    (lambda limit: limit.listed("F", INFINITE, ((0, 1),)), None),
    (lambda limit: limit.finite("F", NAN), None),
    (lambda limit: limit.finite("F", INFINITE), None),
    (lambda limit: limit.single("F", 1e39), 3.4028234663852886e38),
    (lambda limit: limit.single("F", NAN), None),
    (lambda limit: limit.single("F", INFINITE), None),
    (lambda limit: limit.single("F", -INFINITE), None),
    (lambda limit: limit.text("F", "abcde", 0, 4), None),
    (lambda limit: limit.text("F", "\u20ac", 0, 4), None),
    (lambda limit: limit.octets("F", b"ab", 3, 3), None),
]


@for_each(
    ("number", "policy"),
    itertools.product(range(len(FITTING)), [Clamp, DropField, DropMessage, Error]),
)
def test_what_fits_passes_every_policy(number, policy):
    use, expected = FITTING[number]
    counted = []
    result = use(policy(lambda *what: counted.append(what)))
    assert (result, type(result)) == (expected, type(expected))
    assert counted == []


@pytest.mark.parametrize("policy", [Clamp, DropField, DropMessage, Error])
def test_what_a_map_limits_on_purpose_is_the_nearest_value_and_counted(policy):
    counted = []
    limit = policy(lambda *what: counted.append(what))
    assert limit.within("F", 3, 0, 2) == 2
    assert limit.within("F", -INFINITE, -2.0, 2.0) == -2.0
    assert [what[:2] for what in counted] == [("clamp", "F")] * 2
    assert counted[0][2] == "3 is outside 0 .. 2 of the map"
    assert str(limit.within("F", NAN, -2.0, 2.0)) == "nan"
    assert len(counted) == 2


@pytest.mark.parametrize(("use", "nearest"), OUTSIDE)
def test_what_does_not_fit_is_never_a_wrong_number(use, nearest):
    counted = []

    def count(policy, field, reason):
        assert reason
        counted.append((policy, field))

    if nearest is None:
        with pytest.raises(OutOfRangeError, match="F: ") as caught:
            use(Clamp(count))
        assert (caught.value.policy, caught.value.field) == ("not_clampable", "F")
    else:
        assert use(Clamp(count)) == nearest
        assert counted.pop() == ("clamp", "F")
    assert use(DropField(count)) is None
    assert counted == [("drop_field", "F")]
    for policy, name in ((DropMessage, "drop_message"), (Error, "error")):
        with pytest.raises(OutOfRangeError) as caught:
            use(policy(count))
        assert (caught.value.policy, caught.value.field) == (name, "F")
    assert len(counted) == 1


def limited(policy):
    """A command whose minutes and seconds have a limit each; the seconds are always clamped."""

    def translate(source):
        stamp = ReportTime.TimeStamp(minutes=1, seconds=connection.clamp.integer("S", 70.0, 0, 59))
        authority = getattr(connection, policy).integer("M", source.data, 0, 59)
        return SetTime(time_stamp=stamp) if authority is not None else minutes(0)

    connection = command(translate=translate)
    return connection


@pytest.mark.parametrize(
    ("policy", "value", "passed", "counted", "level"),
    [
        ("clamp", 60.0, 1, "clamp", "warning"),
        ("clamp", NAN, 0, "not_clampable", "warning"),
        ("drop_field", 60.0, 1, "drop_field", "warning"),
        ("drop_field", NAN, 1, "drop_field", "warning"),
        ("drop_message", 60.0, 0, "drop_message", "warning"),
        ("error", 60.0, 0, "error", "error"),
    ],
)
def test_counters_name_field_and_policy(
    world, setting, caplog, policy, value, passed, counted, level
):
    connection = setting.open(limited(policy))
    setting.say(1.0)
    connection.status()
    caplog.clear()
    setting.say(value)
    counts = world.counters.snapshot()
    assert counts[f"bridge.drive.out_of_range.{counted}.M"] == 1
    assert counts["bridge.drive.out_of_range.clamp.S"] == 2
    assert connection.statistics.passed == 1 + passed
    assert world.count(SetTime.CODE) == 1 + passed
    assert setting.drops(connection) == ({} if passed else {"out_of_range": 1})
    world.run(0.1)
    status = connection.status()
    assert status.level == level
    assert (f"out of range: {counted} M", "1") in status.values
    records = [record for record in caplog.records if "out_of_range" in record.message]
    names = {"drop_field": [], "error": ["ERROR"]}.get(counted, ["WARNING"])
    assert [record.levelname for record in records] == names
    world.run(0.1)
    assert connection.status().level == "ok"  # a matter of the past


def test_a_source_of_unusable_values_is_silent(world, setting):
    peer = world.probe(str(PEER))

    def translate(source):
        return minutes(connection.drop_message.integer("M", source.data, 0, 59))

    connection = setting.open(command(translate=translate, silence_timeout=1.0, safe_value=safe))
    setting.say(*[NAN] * 30, every=0.1)
    assert peer.take() == [minutes(0)]
    assert connection.is_silent
    setting.say(5.0)
    assert peer.take() == [minutes(5)]
