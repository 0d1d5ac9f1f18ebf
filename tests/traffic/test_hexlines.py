"""Hexadecimal text as people copy it."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.live.traffic.captures import TrafficError, parse_hex


@pytest.mark.parametrize(
    "line",
    [
        "0240",
        "02 40\n",
        "\t02:40\r\n",
        "02-40",
        "0x0240",
        "0x02, 0x40",
        "0X02 0X40  # a comment",
        r"\x02\x40",
        "02 40 // ReportStatus",
        "02 40 ; ReportStatus",
        "02_40",
    ],
)
def test_notations(line):
    assert parse_hex(line) == b"\x02\x40"


@pytest.mark.parametrize("line", ["", "   \n", "# only a comment", "// another", ";"])
def test_lines_without_bytes(line):
    assert parse_hex(line) == b""


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("02 4g", "column 5: 'g' is no hexadecimal digit"),
        ("0x02 0xé0", "column 8: 'é' is no hexadecimal digit"),
        ("hello", "column 1: 'h'"),
        ("02 4", "3 hexadecimal digits make no whole number of bytes"),
        ("{}", "column 1: '{'"),
    ],
)
def test_other_text_says_where(line, reason):
    with pytest.raises(TrafficError) as caught:
        parse_hex(line)
    assert str(caught.value).startswith(reason)


@given(st.binary(), st.sampled_from([" ", ":", ""]))
def test_every_byte_string_comes_back(data, separator):
    assert parse_hex(separator.join(f"{byte:02x}" for byte in data)) == data


@given(st.text())
def test_no_text_raises_anything_else(text):
    with contextlib.suppress(TrafficError):
        assert isinstance(parse_hex(text), bytes)
