"""Bytes worked out by hand from the layout rules, and what out-of-range values do."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from codec_support import library, load, read_messages, render

from jausml.runtime import core_messages as core
from jausml.runtime.message import DecodeError, EncodeError, read_code

if TYPE_CHECKING:
    from types import ModuleType

MOBILITY = library("mobility")[2]


def test_set_wrench_effort_with_four_of_twelve_fields() -> None:
    data = bytes.fromhex("0504 7008 FF7F FFFF 80 00")
    message = MOBILITY.SetWrenchEffort.decode(data)
    assert message == MOBILITY.SetWrenchEffort(
        propulsive_rotational_effort_y=pytest.approx(-0.0015259, abs=1e-7),
        propulsive_rotational_effort_z=100.0,
        resistive_linear_effort_x=pytest.approx(50.196, abs=1e-3),
        resistive_rotational_effort_z=0.0,
    )
    assert message.encode() == data


def test_report_control_puts_the_subsystem_first() -> None:
    message = core.ReportControl(200, 1, 2, authority_code=127)
    assert message.encode() == bytes.fromhex("0D40 C800 01 02 7F")


def test_mandatory_fields_between_optional_ones() -> None:
    segment = MOBILITY.ReportGlobalPathSegment(
        p1_latitude=-90.0,
        p1_longitude=-180.0,
        p2_latitude=90.0,
        p2_altitude=-10000.0,
        p2_longitude=180.0,
        weighting_factor=500.0,
    )
    assert segment.encode() == bytes.fromhex(
        "0F44 02 00000000 00000000 FFFFFFFF FFFFFFFF 00000000 FFFF"
    )


def test_bits_of_a_time_stamp() -> None:
    stamp = core.SetTime.TimeStamp(milliseconds=999, seconds=59, minutes=1, hour=23, day=31)
    bits = 999 | 59 << 10 | 1 << 16 | 23 << 22 | 31 << 27
    assert core.SetTime(time_stamp=stamp).encode() == b"\x11\x00\x01" + bits.to_bytes(4, "little")
    assert core.SetTime.TimeStamp.from_integer(bits) == stamp


def test_embedded_message_has_a_count_of_four_bytes() -> None:
    query = MOBILITY.QueryVelocityState(presence_vector=0x41).encode()
    message = core.CreateEvent(7, core.CreateEvent.EventType.PERIODIC_SC, 1092.0, query)
    assert message.encode() == bytes.fromhex("F001 07 00 FFFF 04000000 0424 4100")
    assert core.CreateEvent.decode(message.encode()) == message


def test_nested_lists() -> None:
    report = core.ReportServices(
        [
            core.ReportServices.NodeSeq(
                core.ReportServices.NodeRec(1),
                [
                    core.ReportServices.ComponentSeq(
                        core.ReportServices.ComponentRec(2, 0),
                        [core.ReportServices.ServiceRec("urn", 1, 0)],
                    )
                ],
            )
        ]
    )
    assert report.encode() == bytes.fromhex("034B 01 01 01 02 00 01 03") + b"urn" + b"\x01\x00"


def test_variant_is_told_by_its_tag() -> None:
    query = core.QueryEvents(core.QueryEvents.EventIDRec(9))
    assert query.encode() == bytes.fromhex("F021 02 09")
    assert core.QueryEvents.decode(query.encode()) == query
    with pytest.raises(DecodeError, match="tag 4 names no option"):
        core.QueryEvents.decode(bytes.fromhex("F021 04 09"))


def test_fixed_string_is_padded_and_cut_at_the_first_nul() -> None:
    reject = core.RejectEventRequest(1, error_message="no")
    data = reject.encode()
    assert data == bytes.fromhex("F401 02 01") + b"no" + bytes(78)
    assert core.RejectEventRequest.decode(data[:8] + b"x" + data[9:]) == reject
    for text, reason in (("x" * 81, "length 81"), ("a\0b", "NUL"), ("€", "Latin-1")):
        with pytest.raises(EncodeError, match=reason):
            core.RejectEventRequest(1, error_message=text).encode()


def test_unknown_bits_of_the_presence_vector_are_refused() -> None:
    with pytest.raises(DecodeError, match="unknown bits in presence vector 0x200"):
        MOBILITY.ReportVelocityState.decode(bytes.fromhex("0444 0002"))


def test_a_value_that_the_set_does_not_list_is_taken_but_not_sent() -> None:
    emergency = core.SetEmergency.decode(bytes.fromhex("0600 0000"))
    assert emergency.emergency_code == 0
    with pytest.raises(EncodeError, match=r"emergency_code: 0 is outside 1 \.\. 1"):
        emergency.encode()


def test_a_count_beyond_the_bytes_is_refused_before_memory_is_taken() -> None:
    with pytest.raises(DecodeError, match="count 65535 needs more than the 2 bytes that follow"):
        core.ReportElementList.decode(bytes.fromhex("1B44 FFFF 0100"))


def test_a_length_beyond_the_bytes_is_refused_before_memory_is_taken() -> None:
    with pytest.raises(DecodeError, match="length 4294967295 is more than the 1 bytes"):
        core.Event.decode(bytes.fromhex("F141 01 02 FFFFFFFF 00"))


def test_bytes_after_the_body_are_refused() -> None:
    with pytest.raises(DecodeError, match="Standby: 1 bytes follow the body"):
        core.Standby.decode(bytes.fromhex("0300 00"))


def test_another_message_is_refused() -> None:
    with pytest.raises(DecodeError, match="message code 0x0004 is another message's"):
        core.Standby.decode(bytes.fromhex("0400"))
    with pytest.raises(DecodeError, match="1 bytes cannot hold it"):
        read_code(b"\x00")


@pytest.mark.parametrize("value", [327.68, -327.69, math.nan, math.inf, -math.inf, 1e308, "1"])
def test_values_out_of_range_are_not_sent(value: Any) -> None:
    with pytest.raises(EncodeError, match="velocity_x"):
        MOBILITY.ReportVelocityState(velocity_x=value).encode()


@pytest.mark.parametrize(("value", "raw"), [(-327.68, "00000000"), (327.67, "ffffffff")])
def test_both_ends_of_a_range_are_exact(value: float, raw: str) -> None:
    data = MOBILITY.ReportVelocityState(velocity_x=value).encode()
    assert data[4:].hex() == raw
    back = MOBILITY.ReportVelocityState.decode(data)
    assert back.velocity_x == pytest.approx(value, abs=1e-12)
    assert back.encode() == data


@pytest.mark.parametrize("value", [-1, 256, 1.5, None, "1"])
def test_integers_out_of_range_are_not_sent(value: Any) -> None:
    with pytest.raises(EncodeError):
        core.RequestControl(value).encode()


def test_values_are_rounded_to_the_nearest_step() -> None:
    step = 1092.0 / 0xFFFF
    for offset, raw in ((0.49, 10), (0.51, 11)):
        data = core.ConfirmEventRequest(0, 0, (10 + offset) * step).encode()
        assert int.from_bytes(data[4:], "little") == raw


EVERY_KIND = Path(__file__).parent / "every_kind.xmi"


@pytest.fixture(scope="module")
def kinds() -> ModuleType:
    return load(render(read_messages(EVERY_KIND)), "kinds_messages")


def message_of_every_kind(kinds: ModuleType) -> Any:
    cls = kinds.Kinds
    numbers = cls.Numbers(
        -2, 1.0, 7.9, 7.1, 0.5, gap=cls.Gap.OFF, matrix=[1, 2, 3, 4], labels=["a", "bc"]
    )
    return cls(
        first=cls.First(1.0),
        numbers=numbers,
        lists=[cls.Inner([1, 2]), cls.Inner()],
        choice=cls.A(cls.V(5, -1.0)),
    )


def test_every_kind_of_field_at_once(kinds: ModuleType) -> None:
    message = message_of_every_kind(kinds)
    expected = (
        "0001 00 0000803F FEFF FFFFFFFFFFFFFFFF 07 08 000000000000E03F 00 01020304 01 61 02 6263"
        "0200 02 0102 00 00 05 000080BF"
    )
    assert message.encode() == bytes.fromhex(expected)
    assert kinds.Kinds.decode(message.encode()).encode() == message.encode()


def test_options_that_are_no_records_have_classes(kinds: ModuleType) -> None:
    cls = kinds.Kinds
    message = message_of_every_kind(kinds)
    for choice, tail in ((cls.B([cls.P(1.0)]), "01 01 0000803F"), (cls.Nothing(), "02 00")):
        message.choice = choice
        data = message.encode()
        assert data.endswith(bytes.fromhex(tail))
        assert cls.decode(data).choice == choice


def test_a_gap_in_the_value_set(kinds: ModuleType) -> None:
    message = message_of_every_kind(kinds)
    for legal in (0, 4, 7):
        message.numbers.gap = legal
        assert kinds.Kinds.decode(message.encode()).numbers.gap == legal
    for illegal in (1, 3, 8, 255):
        message.numbers.gap = illegal
        with pytest.raises(EncodeError, match="gap"):
            message.encode()


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("numbers.real_", math.nan),
        ("numbers.real_", math.inf),
        ("numbers.signed", 32768),
        ("numbers.matrix", [1, 2, 3]),
        ("numbers.matrix", [1, 2, 3, 256]),
        ("numbers.wide", 1.1),
        ("first.x", 1e39),
        ("choice.v.index", 2),
        ("lists", [None] * 4),
    ],
)
def test_what_has_no_place_on_the_wire_raises_encode_error(
    kinds: ModuleType, path: str, value: Any
) -> None:
    message = message_of_every_kind(kinds)
    *way, last = path.split(".")
    owner = message
    for name in way:
        owner = getattr(owner, name)
    setattr(owner, last, value)
    with pytest.raises(EncodeError, match=last):
        message.encode()


def test_a_variable_field_of_an_integer_type_takes_whole_numbers(kinds: ModuleType) -> None:
    message = message_of_every_kind(kinds)
    message.choice.v = kinds.Kinds.V(1, -3.0)
    assert message.encode().endswith(bytes.fromhex("00 01 FD"))
    message.choice.v = kinds.Kinds.V(1, 0.5)
    with pytest.raises(EncodeError, match="not a whole number"):
        message.encode()
    with pytest.raises(DecodeError, match="index 9 names no type"):
        kinds.Kinds.decode(message_of_every_kind(kinds).encode()[:-5] + b"\x09\0\0\0\0")
