"""Lists of records that are bytes until somebody asks for an element."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.wire import DecodeError, Number, RowLayout, read_records, write_records
from jausml.runtime.wire.records import FEWEST, Records, Rows


@dataclass
class Point:
    """A record as generated messages have them."""

    ROW: ClassVar[RowLayout] = RowLayout(
        Number("x", "H", 0, 65535), Number("y", "B", 0, 255, bit=0x1), presence="B"
    )
    x: int = 0
    y: int | None = None

    def write_to(self, out):
        out += struct.pack("<BH", self.y is not None, self.x)
        if self.y is not None:
            out += struct.pack("<B", self.y)

    @classmethod
    def read_from(cls, buffer, offset):
        presence, x = struct.unpack_from("<BH", buffer, offset)
        if not presence & 1:
            return cls(x), offset + 3
        return cls(x, *struct.unpack_from("<B", buffer, offset + 3)), offset + 4


def written(points):
    out = bytearray(b"head")
    write_records(points, out)
    return bytes(out)


def read(points):
    found, end = read_records(Point, written(points) + b"tail", 4, len(points))
    assert end == len(written(points))
    return found


POINTS = [Point(n, 3 * n) for n in range(FEWEST)]
LISTS = st.lists(st.builds(Point, st.integers(0, 65535), st.none() | st.integers(0, 255)))


@given(points=LISTS)
def test_a_list_is_what_was_written(points):
    assert written(read(points)) == written(points)
    assert read(points) == points
    assert list(read(points)) == points


@given(points=LISTS, index=st.integers(-20, 20))
def test_an_element_is_the_one_of_its_index(points, index):
    found = read(points)
    if -len(points) <= index < len(points):
        assert found[index] == points[index]
        assert found[index] is found[index]
    else:
        with pytest.raises(IndexError):
            found[index]


def test_few_elements_and_those_that_do_not_lie_alike_are_made():
    assert isinstance(read(POINTS), Records)
    assert isinstance(read(POINTS[1:]), list)
    assert isinstance(read([*POINTS, Point(1)]), list)


def test_who_looks_at_an_element_leaves_the_list_as_it_is():
    found = read(POINTS)
    assert (found[1].x, found[-1].x, len(found)) == (1, FEWEST - 1, FEWEST)
    assert isinstance(found.alike, Rows)


def test_a_changed_element_is_written():
    found = read(POINTS)
    found[2].x = 500
    assert found.alike is None
    assert written(found) == written([*POINTS[:2], Point(500, 6), *POINTS[3:]])


@pytest.mark.parametrize(
    "change",
    [
        lambda found: found.append(Point(9)),
        lambda found: found.insert(0, Point(9)),
        lambda found: found.pop(),
        lambda found: found.__delitem__(slice(1, 3)),
        lambda found: found.__setitem__(1, Point(9)),
        lambda found: found.reverse(),
        lambda found: found.extend([Point(9), Point(8)]),
        lambda found: found.clear(),
    ],
)
def test_a_list_changes_as_a_list_does(change):
    found, listed = read(POINTS), list(POINTS)
    change(found)
    change(listed)
    assert found == listed
    assert repr(found) == repr(listed)
    assert written(found) == written(listed)


def test_a_field_that_nobody_knows_is_refused():
    data = written(POINTS).replace(b"head\x01", b"head\x03")
    with pytest.raises(DecodeError, match="presence"):
        read_records(Point, data, 4, len(POINTS))


def test_a_list_that_ends_too_early_is_refused():
    with pytest.raises(struct.error):
        read_records(Point, written(POINTS)[:-1], 4, len(POINTS))
