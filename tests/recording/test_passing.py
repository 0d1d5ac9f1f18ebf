"""Messages of a recording and what came of them: compared by what the map makes of each."""

from __future__ import annotations

import struct
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recorded_systems import MODEL
from rosbags.typesys import Stores, get_typestore

from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import load_catalogue
from jausml.live.recording.passing import (
    AHEAD,
    UNKNOWN,
    Given,
    Made,
    RecordedTranslation,
    Taken,
    passed,
)
from jausml.live.systems.state import ConnectionState
from jausml.live.systems.ways import topics_of_joins
from jausml.runtime.conversions import Time, time_to_timestamp
from jausml.runtime.wire import TimeStamp

SECOND = 10**9
AT = 1_700_000_000 * SECOND


@cache
def model():
    return read_models([MODEL], allow_outside=True).model


def connection_of(model, name):
    (found,) = [each for each in model.instances(bridge.Connection) if each.name == name]
    return found.eContainer(), found


@pytest.fixture(scope="module")
def translated():
    """Returns what a connection makes of payloads."""

    def made_of(name, *payloads):
        messages = [Taken(AT + index * SECOND, 10, data) for index, data in enumerate(payloads)]
        with RecordedTranslation(
            model().metamodels, connection_of(model(), name)[1]
        ) as translation:
            return translation.made_of(messages), translation

    return made_of


def payload(name, **fields):
    return load_catalogue().encode({"message": name, "fields": fields})


def test_the_clock_of_the_bridge_may_be_another_one(translated):
    made, translation = translated(
        "pose", payload("ReportLocalPose", X=1.5, Roll=0.0, Pitch=0.0, Yaw=0.0),
        payload("ReportLocalPose", Roll=0.0, Pitch=0.0, Yaw=0.0),
    )  # fmt: skip
    assert made[0].fixed[4:12] == bytes(8)
    assert set(made[0].fixed[12:]) == {255}
    assert (made[1].counter, made[1].reason) == ("absent_field", "X")
    of_another_time = made[0].data[:4] + struct.pack("<iI", 7, 5) + made[0].data[12:]
    moved = of_another_time[:20] + struct.pack("<d", 1.25) + of_another_time[28:]
    for there, is_passed in ((of_another_time, True), (moved, False)):
        assert passed(made, [Given("", translation.comparable(there))]) == [is_passed, False]


def test_the_policy_of_the_connection_counts_and_not_the_map_alone(translated):
    """The map leaves it to the connection what becomes of a place beyond its field."""
    far = struct.pack("<iII1s3xI", 0, 0, 1, b"\0", 1) + bytes(4)
    odometry = (
        b"\0\1\0\0" + far + struct.pack("<7d", 1e9, 0, 0, 0, 0, 0, 1) + bytes(36 * 8 + 48 + 36 * 8)
    )
    (made,), _ = translated("estimate", odometry)
    assert made.counter == "out_of_range"
    assert made.reason.startswith("X: ")


@given(st.integers(10**9 * SECOND, 2 * 10**9 * SECOND))
def test_no_byte_of_a_stamp_is_the_same_by_both_clocks(nanoseconds):
    def stamps(at):
        instant = Time(*divmod(at, SECOND))
        yield struct.pack("<II", *instant)
        parts = time_to_timestamp(instant)
        yield TimeStamp(*parts).to_integer().to_bytes(4, "little")

    for one, other in zip(stamps(nanoseconds), stamps(nanoseconds + AHEAD), strict=True):
        assert not any(a == b for a, b in zip(one, other, strict=True))


def made(text):
    return Made(text, b"\xff" * len(text))


def test_those_that_became_the_same_are_told_apart_by_their_number_alone():
    same, other = made(b"aa"), made(b"bb")
    refused = Made(counter="out_of_range", reason="x")
    came = [Given("1.1.1", b"aa"), Given("1.1.2", b"aa"), Given("1.1.1", b"cc")]
    assert passed([same, other, refused, UNKNOWN], came) == [True, False, False, None]
    # One copy each went to two receivers: of two messages that are alike, one is missing.
    assert passed([same, same], came) == [None, None]
    assert passed([same, same], [*came, Given("1.1.2", b"aa")]) == [True, True]


ROBOT = """
import mappings.primitive_driver

system alone {
    bridge robot {
        address: 100.1.10
        provides: PrimitiveDriver
        controlTimeout: 2
        connection drive {
            map: wrench_effort
            direction: jausToRos
            exchange: message
            silenceTimeout: 0.5
            topic cmd_vel
        }
        quantity max_speed { value: 4.0  units: "m/s" }
    }
}
"""


def test_a_quantity_of_the_bridge_comes_before_that_of_the_map(tmp_path):
    file = tmp_path / "alone.ros2jaus"
    file.write_text(ROBOT, encoding="utf-8")
    read = read_models([file], notations=NOTATIONS).model
    half = payload("SetWrenchEffort", PropulsiveLinearEffortX=50.0)
    with RecordedTranslation(read.metamodels, connection_of(read, "drive")[1]) as translation:
        (made,) = translation.made_of([Taken(AT, 10, half)])
    assert struct.unpack_from("<d", made.data, 4)[0] == pytest.approx(2.0, abs=0.001)


WAYPOINTS = MODEL.parents[3] / "models" / "examples" / "waypoints" / "waypoints.ros2jaus"


def test_what_is_joined_counts_while_it_is_fresh():
    read = read_models([WAYPOINTS], notations=NOTATIONS, allow_outside=True).model
    _, joined = connection_of(read, "global_pose")
    fix, imu = serialized_pose()
    messages = [
        Taken(AT, 0, imu, "imu"),
        Taken(AT + SECOND // 10, 0, fix),
        Taken(AT + 2 * SECOND, 0, fix),
    ]
    with RecordedTranslation(read.metamodels, joined) as translation:
        fresh, stale = translation.made_of(messages)
    assert len(fresh.data) == len(stale.data) + 6  # roll, pitch and yaw
    for node, topic in (("/vehicle", "/vehicle/imu"), ("/left", "/left/imu")):
        connection = ConnectionState(f"{node}/waypoint_vehicle", "global_pose")
        assert list(topics_of_joins(None, connection, joined)) == [(topic, "imu")]


JOINED = """

bridge vehicle {
    address: 100.1.20
    provides: GlobalPoseSensor
    connection global_pose {
        map: global_pose
        topic fix
        topic imu { join: ownImu }
    }
}
"""


def test_a_join_is_counted_as_bridges_count_it_by_its_name_in_the_model(tmp_path):
    text = (
        WAYPOINTS.parents[2] / "library" / "mappings" / "global_pose_sensor.ros2jaus"
    ).read_text(encoding="utf-8")
    changed = text.replace("join imu ", "join ownImu ").replace("imu.", "ownImu.")
    changed = changed.replace(
        "freshness: 0.5  whenStale: leave", "freshness: 0.5  whenStale: dropMessage"
    )
    file = tmp_path / "alone.ros2jaus"
    file.write_text(changed + JOINED, encoding="utf-8")
    read = read_models([file], notations=NOTATIONS).model
    fix, imu = serialized_pose()
    messages = [Taken(AT, 0, imu, "ownImu"), Taken(AT, 0, fix), Taken(AT + 2 * SECOND, 0, fix)]
    with RecordedTranslation(read.metamodels, connection_of(read, "global_pose")[1]) as translation:
        fresh, stale = translation.made_of(messages)
    assert fresh.data
    assert stale.counter == "stale_join_ownImu"


def serialized_pose():
    """What ROS serializes of a fix and of the attitude that is joined to it."""
    store = get_typestore(Stores.ROS2_JAZZY)
    make = store.types
    stamp = make["builtin_interfaces/msg/Time"](sec=1_700_000_000, nanosec=0)
    header = make["std_msgs/msg/Header"](stamp=stamp, frame_id="")
    none, vector = np.zeros(9), make["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    status = make["sensor_msgs/msg/NavSatStatus"](status=0, service=1)
    turn = make["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    messages = {
        "sensor_msgs/msg/NavSatFix": (header, status, 52.0, 11.0, 80.0, none, 0),
        "sensor_msgs/msg/Imu": (header, turn, none, vector, none, vector, none),
    }
    return [bytes(store.serialize_cdr(make[kind](*each), kind)) for kind, each in messages.items()]
