"""JUDP datagrams as a bystander sees them."""

import json
import re
from functools import cache

import pytest
from capture_files import QUERY_STATUS
from hypothesis import given, settings
from hypothesis import strategies as st
from wire_vectors import golden_vectors

from jausml.live.messages import load_catalogue
from jausml.live.traffic import observing
from jausml.live.traffic.frames import Datagram, Endpoint
from jausml.live.traffic.observing import Observer
from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.packet import DataFlags, Packet
from jausml.runtime.transports.ports import present_frame

catalogue = cache(load_catalogue)
ROBOT, OPERATOR = JausAddress(200, 1, 2), JausAddress(101, 1, 1)
IDENTIFICATION = bytes.fromhex("004b 02 1127 05") + b"robot"


def observe(*datagrams, source=None):
    observer = Observer(catalogue())
    return [
        seen
        for number, data in enumerate(datagrams, 1)
        for seen in observer.observe(Datagram(data, source, source, float(number), number))
    ]


def fragments(payload, size=4, first=65534):
    parts = [payload[at : at + size] for at in range(0, len(payload), size)]
    flags = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (len(parts) - 2), DataFlags.LAST]
    return [
        Packet(OPERATOR, ROBOT, part, first + n & 0xFFFF, data_flags=flag).encode()
        for n, (part, flag) in enumerate(zip(parts, flags, strict=True))
    ]


def test_header_and_message():
    (seen,) = observe(QUERY_STATUS)
    assert seen.to_json() == {
        "version": 2,
        "data_size": 16,
        "priority": 1,
        "broadcast": 0,
        "ack_nak": 0,
        "data_flags": 0,
        "destination": {"subsystem": 200, "node": 1, "component": 2},
        "source": {"subsystem": 101, "node": 1, "component": 1},
        "sequence": 7,
        "payload": "0220",
        "message": {
            "message": "QueryStatus",
            "code": "0x2002",
            "service": "urn:jaus:jss:core:Management",
            "service_version": "1.0",
            "fields": {},
        },
    }
    assert not seen.error


def test_several_messages_share_one_version_byte():
    seen = observe(QUERY_STATUS + QUERY_STATUS[1:])
    assert [observation.message.entry.name for observation in seen] == [
        "QueryStatus",
        "QueryStatus",
    ]


def test_the_data_size_is_what_the_header_says():
    compressed = bytes.fromhex("02 40 1200 0000 01 0201c800 01016500 0220 0700")
    reserved = bytes.fromhex("20 1100 01 0201c800 01016500 0220ff 0700")
    seen = observe(compressed, b"\2" + reserved + compressed[1:])
    assert [
        (observation.data_size, len(observation.packet.payload))
        for observation in seen
        if observation.packet
    ] == [(18, 2), (18, 2)]


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "the datagram is empty"),
        (b"\x02", "larger than the datagram"),
        (b"\x01" + bytes(20), "JUDP version 1 (AS5669) is not supported"),
        (b"\x03" + QUERY_STATUS[1:], "JUDP version 3 is not supported"),
        (b"JAUS01.0" + bytes(16), "JAUS Reference Architecture"),
        (QUERY_STATUS[:-1], "larger than the datagram (16 bytes)"),
        (QUERY_STATUS[:2] + b"\x0d" + QUERY_STATUS[3:], "too small for its header"),
        (present_frame([ROBOT]), "between the jausml processes of one host"),
    ],
)
def test_datagrams_that_cannot_be_read(data, reason):
    (seen,) = observe(data)
    assert seen.error
    assert list(seen.to_json()) == ["error"]
    assert reason in seen.error
    assert any(reason in line for line in observing.lines(seen))


def test_what_follows_a_good_message_is_told():
    good, rest = observe(QUERY_STATUS + b"xyz")
    assert good.message is not None
    assert rest.error.startswith("bytes follow the last message")


def test_a_payload_that_cannot_be_decoded_keeps_its_header():
    packet = Packet(ROBOT, OPERATOR, b"\x01\x44\xde\xad", 9)
    (seen,) = observe(packet.encode())
    printed = seen.to_json()
    assert printed["sequence"] == 9
    assert printed["payload"] == "0144dead"
    assert printed["error"].startswith("no message has the code 0x4401")
    assert "message" not in printed
    assert seen.error


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_messages_of_several_packets(order):
    parts = fragments(IDENTIFICATION)
    assert len(parts) == 3
    seen = observe(*(parts[index] for index in order))
    assert [observation.message is None for observation in seen] == [True, True, False]
    assert all("of a message of several" in observation.fragment for observation in seen[:2])
    assert not any(observation.error for observation in seen)
    assert ["error" in observation.to_json() for observation in seen] == [False, False, False]
    assert ["fragment" in observation.to_json() for observation in seen] == [True, True, False]
    whole = seen[-1].to_json()["message"]
    assert whole["fields"]["ReportIdentificationRec"]["Identification"] == "robot"


def test_acknowledgements_have_no_message():
    (seen,) = observe(bytes.fromhex("02000e0031010165000201c8000100"))
    printed = seen.to_json()
    assert printed["ack_nak"] == 3
    assert not {"message", "error"} & printed.keys()


def test_frames_between_processes_of_a_host_are_no_traffic():
    observer = Observer(catalogue())
    here = Endpoint("127.0.0.1", 3794)
    assert list(observer.observe(Datagram(present_frame([ROBOT]), here, here))) == []
    assert observer.host_frames == 1


@pytest.mark.beside("golden/judp_datagrams.jsonl")
def test_every_captured_datagram():
    for vector in golden_vectors("judp_datagrams.jsonl"):
        header = vector["header"]
        (seen,) = observe(bytes.fromhex(vector["hex"]))
        printed = seen.to_json()
        if header["version"] == 1:
            assert list(printed) == ["error"]
            assert "version 1" in printed["error"]
            continue
        content = {"message", "error", "fragment"}
        stated = {name: header[name] for name in printed if name not in content}
        assert {name: value for name, value in printed.items() if name in stated} == stated
        assert "destination" in stated
        assert "payload" in stated
        is_empty = header["kind"] == "acknowledgement"
        assert is_empty != bool(content & printed.keys())


def test_text_shows_header_fields_units_and_names():
    here = Endpoint("127.0.0.1", 3794)
    pose = bytes.fromhex("0244 0300 00000080 ffffffff")
    seen = observe(
        Packet(JausAddress(65535, 255, 255), ROBOT, bytes.fromhex("02400100000000"), 3).encode(),
        Packet(OPERATOR, ROBOT, pose, 4).encode(),
        source=here,
    )
    shown = [line for observation in seen for line in observing.lines(observation)]
    assert shown == [
        "00:00:01.000000  127.0.0.1:3794 > 127.0.0.1:3794  200.1.2 > *.*.*  #3  "
        "ReportStatus 0x4002 (urn:jaus:jss:core:Management/1.0)",
        "  ReportStatusRec",
        "    Status: 1 (READY)",
        "    Reserved: 0",
        "00:00:02.000000  127.0.0.1:3794 > 127.0.0.1:3794  200.1.2 > 101.1.1  #4  "
        "ReportGlobalPose 0x4402 (urn:jaus:jss:mobility:GlobalPoseSensor/1.0)",
        "  GlobalPoseRec",
        "    Latitude: 0.000000021 degree",
        "    Longitude: 180.000000000 degree",
    ]


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=60) | st.binary(max_size=30).map(lambda tail: QUERY_STATUS[:13] + tail))
def test_no_datagram_raises(data):
    for seen in observe(data):
        assert json.loads(json.dumps(seen.to_json()))
        assert all(re.fullmatch(r"[^\n]*", line) for line in observing.lines(seen))
