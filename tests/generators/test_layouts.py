"""What generated classes do with bytes and values; tests/vectors has plain bytes and fields."""

import math
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from codec_support import library, load, read_messages, render
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime import messages as core
from jausml.runtime.wire.codec import scaled
from jausml.runtime.wire.message import DecodeError, EncodeError


@pytest.fixture(scope="module")
def mobility() -> ModuleType:
    return library("mobility")[2]


def test_bits_of_a_time_stamp():
    stamp = core.SetTime.TimeStamp(milliseconds=999, seconds=59, minutes=1, hour=23, day=31)
    bits = 999 | 59 << 10 | 1 << 16 | 23 << 22 | 31 << 27
    assert core.SetTime(time_stamp=stamp).encode() == b"\x11\x00\x01" + bits.to_bytes(4, "little")
    assert core.SetTime.TimeStamp.from_integer(bits) == stamp


@pytest.mark.parametrize("value", [327.68, -327.69, math.nan, math.inf, -math.inf, 1e308, "1"])
def test_values_out_of_range_are_not_sent(mobility, value):
    with pytest.raises(EncodeError, match="velocity_x"):
        mobility.ReportVelocityState(velocity_x=value).encode()


@pytest.mark.parametrize(("value", "raw"), [(-327.68, "00000000"), (327.67, "ffffffff")])
def test_both_ends_of_a_range_are_exact(mobility, value, raw):
    data = mobility.ReportVelocityState(velocity_x=value).encode()
    assert data[4:].hex() == raw
    back = mobility.ReportVelocityState.decode(data)
    assert back.velocity_x == pytest.approx(value, abs=1e-12)
    assert back.encode() == data


@for_each("value", [-1, 256, 1.5, None, "1"])
def test_integers_out_of_range_are_not_sent(value):
    with pytest.raises(EncodeError):
        core.RequestControl(value).encode()


def test_values_are_rounded_to_the_nearest_step():
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


def test_every_kind_of_field_at_once(kinds):
    message = message_of_every_kind(kinds)
    expected = (
        "0001 00 0000803F FEFF FFFFFFFFFFFFFFFF 07 08 000000000000E03F 00 01020304 01 61 02 6263"
        "0200 02 0102 00 00 05 000080BF"
    )
    assert message.encode() == bytes.fromhex(expected)
    assert kinds.Kinds.decode(message.encode()).encode() == message.encode()


def test_options_that_are_no_records_have_classes(kinds):
    cls = kinds.Kinds
    message = message_of_every_kind(kinds)
    for choice, tail in ((cls.B([cls.P(1.0)]), "01 01 0000803F"), (cls.Nothing(), "02 00")):
        message.choice = choice
        data = message.encode()
        assert data.endswith(bytes.fromhex(tail))
        assert cls.decode(data).choice == choice


def test_a_gap_in_the_value_set(kinds):
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
def test_what_has_no_place_on_the_wire_raises_encode_error(kinds, path, value):
    message = message_of_every_kind(kinds)
    *way, last = path.split(".")
    owner = message
    for name in way:
        owner = getattr(owner, name)
    setattr(owner, last, value)
    with pytest.raises(EncodeError, match=last):
        message.encode()


def test_a_variable_field_of_an_integer_type_takes_whole_numbers(kinds):
    message = message_of_every_kind(kinds)
    message.choice.v = kinds.Kinds.V(1, -3.0)
    assert message.encode().endswith(bytes.fromhex("00 01 FD"))
    message.choice.v = kinds.Kinds.V(1, 0.5)
    with pytest.raises(EncodeError, match="not a whole number"):
        message.encode()
    with pytest.raises(DecodeError, match="index 9 names no type"):
        kinds.Kinds.decode(message_of_every_kind(kinds).encode()[:-5] + b"\x09\0\0\0\0")


def more_kinds(kinds: ModuleType) -> Any:
    cls = kinds.More
    head = cls.Head(
        name="ab",
        flags=cls.Flags(mode=cls.Mode.ON, level=0xA5, top=1),
        grid=[-1.0, 1.0, -1.0, 1.0, 1.0, -1.0],
        switches=[cls.S(on=1, count=2), cls.S(on=0, count=15)],
        limited=0.5,
        single=0.0625,
        quantity=cls.Quantity(1, 655.35),
        picture=cls.Picture(cls.PictureFormat.PNG, b"\x01\x02"),
        signed=cls.Signed.MINUS,
    )
    points = [cls.Corner(y=7), cls.Corner(x=1, y=2, z=0x0304)]
    return cls(head, points, cls.Nested(b=cls.B(9)), cls.Two(0x77))


MORE = (
    "0101 03"
    # Presence, name, bits 0-2 and 3-10 and 15 of a u16, 2 x 3 scaled u8, 2 bit fields of u8.
    " 01 61620000 2B85 00FF00FFFF00 21 F0"
    # Double, single, index and scaled u16, format and u16 count and bytes, i32.
    " 000000000000E03F 0000803D 01 FFFF 03 0200 0102 FBFFFFFF"
    # u32 count, each corner with its own presence vector.
    " 02000000 00 07 03 01 02 0403"
    # A sequence in the sequence with a presence vector of its own; a u16 tag.
    " 0000 09 0100 77"
)


def test_more_kinds_of_fields_at_once(kinds):
    message = more_kinds(kinds)
    assert message.encode() == bytes.fromhex(MORE)
    assert kinds.More.decode(bytes.fromhex(MORE)) == message


@pytest.mark.parametrize(
    ("position", "changed", "reason"),
    [
        (2, "07", "More: unknown bits in presence vector 0x7"),
        (3, "03", "More.Head: unknown bits in presence vector 0x3"),
        (30, "04", "More.Quantity: index 4 names no type"),
        (34, "0600", "data: length 6 is more than 5"),
        (42, "04000000", "points: count 4 is more than 3"),
        (42, "FFFFFFFF", "points: count 4294967295 is more than 3"),
        (46, "04", "More.Corner: unknown bits in presence vector 0x4"),
        (53, "0200", "More.Nested: unknown bits in presence vector 0x2"),
        (56, "0200", "More.Either: tag 2 names no option"),
        (56, "0001", "More.Either: tag 256 names no option"),
    ],
)
def test_what_the_layout_does_not_know_is_refused(kinds, position, changed, reason):
    data = bytearray.fromhex(MORE)
    data[position : position + len(changed) // 2] = bytes.fromhex(changed)
    with pytest.raises(DecodeError, match=reason):
        kinds.More.decode(bytes(data))


def test_list_of_fewest_elements_and_no_list_at_all_differ(kinds):
    message = more_kinds(kinds)
    message.points = None
    assert message.encode()[2] == 0x02
    # A list that is too short is taken in both directions.
    short = bytes.fromhex(MORE.replace("02000000 00 07 03 01 02 0403", "00000000"))
    assert kinds.More.decode(short).points == []
    assert kinds.More.decode(short).encode() == short


def test_list_with_too_many_elements_is_refused(kinds):
    message = more_kinds(kinds)
    message.points = message.points[:1] * 4
    with pytest.raises(EncodeError, match=r"points: length 4 is outside 0 \.\. 3"):
        message.encode()


@pytest.mark.parametrize(
    ("path", "legal", "illegal"),
    [
        ("head.limited", [5e-324, 0.5, 1 - 2**-53], [0.0, 1.0, -0.0, math.nan]),
        ("head.single", [2.0**-149, 0.1], [0.0, 0.1001, math.inf]),
        ("head.flags.mode", [0, 3], [1, 2, 4]),
        ("head.flags.level", [0, 255], [-1, 256]),
        ("head.signed", [-5, 10, 20], [-6, -4, 0, 9, 21]),
        ("head.grid", [[-1.0, 1.0] * 3], [[1.0] * 5, [1.0] * 7, [1.01] * 6, [math.nan] * 6]),
        ("head.picture.data", [b"", b"12345"], [b"123456"]),
        ("head.picture.format_index", [0, 3], [1, 2, 255]),
        ("head.name", [None, "", "abcd"], ["abcde", "a\0b"]),
        ("head.quantity", [(1, 0.0), (1, 655.35)], [(1, 655.36), (1, -0.01), (1, math.nan)]),
        ("head.quantity", [(2, -1.0), (2, 5.0)], [(2, 2.0), (2, 4.0), (2, 0.5), (2, -2)]),
        ("head.quantity", [(3, 0.0), (3, 2.0)], [(3, 3.0), (3, 255.0), (0, 0.0), (4, 0.0)]),
    ],
)
def test_legal_values_and_their_neighbours(kinds, path, legal, illegal):
    message = more_kinds(kinds)
    *way, last = path.split(".")
    owner = message
    for name in way:
        owner = getattr(owner, name)

    def put(value: Any) -> None:
        setattr(owner, last, kinds.More.Quantity(*value) if last == "quantity" else value)

    for value in legal:
        put(value)
        assert kinds.More.decode(message.encode()).encode() == message.encode()
    for value in illegal:
        put(value)
        with pytest.raises(EncodeError):
            message.encode()


@pytest.mark.parametrize("value", [None, 3, "x", [1], object(), 10**400, {"a": 1}])
def test_values_of_another_type_raise_nothing_but_encode_error(kinds, value):
    for name in ("head", "nested", "points", "either"):
        message = more_kinds(kinds)
        setattr(message, name, value)
        if value is None and name in ("nested", "points"):
            continue
        with pytest.raises(EncodeError):
            message.encode()
    fields = ("name", "flags", "grid", "switches", "limited", "single", "picture", "signed")
    for name in fields:
        message = more_kinds(kinds)
        setattr(message.head, name, value)
        if name == "name" and (value is None or value == "x"):
            continue
        with pytest.raises(EncodeError):
            message.encode()


def test_nan_and_infinity_of_a_peer_are_taken_but_not_sent(kinds):
    for bits in ("7FF8000000000000", "7FF0000000000000", "FFF0000000000000"):
        number = bytes.fromhex(bits)[::-1]
        data = bytes.fromhex(MORE).replace(bytes.fromhex("000000000000E03F"), number)
        message = kinds.More.decode(data)
        assert not math.isfinite(message.head.limited)
        with pytest.raises(EncodeError, match="limited"):
            message.encode()


def test_bits_that_no_part_has_are_sent_as_zero(kinds):
    data = bytearray.fromhex(MORE)
    data[9] |= 0x78  # bits 11 to 14
    assert kinds.More.decode(bytes(data)).encode() == bytes.fromhex(MORE)


# A range with zero in the middle, one from zero, an angle, degrees of latitude: as in the library.
SCALES = [(-327.68, 327.67), (0.0, 1092.0), (-math.pi, math.pi), (-90.0, 90.0), (-1e5, 1e5)]


@given(st.sampled_from(SCALES), st.sampled_from([8, 16, 32]), st.floats(0.0, 1.0, exclude_max=True))
def test_a_truncating_peer_is_at_most_one_step_low(scale, bits, part):
    lower, upper = scale
    largest = 2**bits - 1
    step = (upper - lower) / largest
    value = lower + part * (upper - lower)
    truncated = int((value - lower) / step)
    received = truncated * step + lower
    assert value - step * 1.001 <= received <= value + step * 0.001
    # We send the nearest: the same integer or the next one, and never another one for what came.
    assert scaled(value, lower, step, largest, "") - truncated in (0, 1)
    assert scaled(received, lower, step, largest, "") == truncated
    nearest = scaled(value, lower, step, largest, "") * step + lower
    assert abs(nearest - value) <= step * 0.501


@pytest.mark.parametrize("bits", [8, 16, 32])
@pytest.mark.parametrize(("lower", "upper"), SCALES)
def test_steps_next_to_the_ends_and_the_middle_come_back(bits, lower, upper):
    largest = 2**bits - 1
    step = (upper - lower) / largest
    for raw in (0, 1, largest // 2, largest // 2 + 1, largest - 1, largest):
        assert scaled(raw * step + lower, lower, step, largest, "") == raw


def test_value_sets_that_count_from_their_lower_limit(kinds):
    cls = kinds.Offsets
    message = cls(
        year=2022,
        gear=cls.Gear.FORWARD,
        flags=cls.Flags(low=1, level=12),
        length=cls.Length(1, 1001),
        years=[1901, 2000],
    )
    assert message.encode() == bytes.fromhex("0601 16 08 21 01 0100 01 64")
    assert cls.decode(message.encode()) == message
    assert cls().encode() == bytes.fromhex("0601 00 00 00 01 0000 01 01")
    for name, value in (("year", 1999), ("year", 22), ("gear", 0), ("years", [1900, 1950])):
        wrong = cls.decode(message.encode())
        setattr(wrong, name, value)
        with pytest.raises(EncodeError, match=name):
            wrong.encode()
    # Beyond the set, but not beyond the wire: carried on, as other values outside of sets are.
    assert cls.decode(bytes.fromhex("0601 FF FF 31 01 FFFF 00 FF")).year == 2255
