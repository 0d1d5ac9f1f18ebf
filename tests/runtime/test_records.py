"""Lists of records of one octet that are bytes until somebody asks for a record."""

from dataclasses import dataclass
from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.wire import Octet, octet_records, write_records
from jausml.runtime.wire.records import OctetRecords


@dataclass
class Cell:
    """A record as generated messages have them."""

    OCTET: ClassVar[Octet] = Octet("cost")
    cost: int = 0

    def write_to(self, out):
        out.append(self.cost)

    @classmethod
    def read_from(cls, buffer, offset):
        return cls(buffer[offset]), offset + 1


def written(cells):
    out = bytearray(b"head")
    write_records(cells, out)
    return bytes(out)


CELLS = [Cell(number) for number in range(9)]


def read():
    return OctetRecords(Cell, bytes(range(9)))


@given(octets=st.binary(max_size=30), index=st.integers(-35, 35))
def test_a_list_is_that_of_its_records(octets, index):
    cells, listed = OctetRecords(Cell, octets), [*map(Cell, octets)]
    assert written(cells) == written(listed) == b"head" + octets
    assert len(cells) == len(listed)
    if -len(listed) <= index < len(listed):
        assert cells[index] == listed[index]
        assert cells[index] is cells[index]
    else:
        with pytest.raises(IndexError):
            cells[index]
    assert cells == listed
    assert [*cells] == listed
    assert written(cells) == b"head" + octets


def test_few_records_are_a_list():
    assert octet_records(Cell, bytes(range(7))) == CELLS[:7]
    assert type(octet_records(Cell, bytes(range(7)))) is list
    assert type(octet_records(Cell, bytes(range(8)))) is OctetRecords


def test_a_changed_record_is_written():
    cells = read()
    cells[2].cost = 50
    assert written(cells) == written([*CELLS[:2], Cell(50), *CELLS[3:]])


@pytest.mark.parametrize(
    "change",
    [
        lambda cells: cells.append(Cell(9)),
        lambda cells: cells.insert(0, Cell(9)),
        lambda cells: cells.pop(),
        lambda cells: cells.__delitem__(slice(1, 3)),
        lambda cells: cells.__setitem__(1, Cell(9)),
        lambda cells: cells.reverse(),
        lambda cells: cells.extend([Cell(9), Cell(8)]),
        lambda cells: cells.clear(),
    ],
)
def test_a_list_changes_as_a_list_does(change):
    cells, listed = read(), list(CELLS)
    change(cells)
    change(listed)
    assert cells == listed
    assert repr(cells) == repr(listed)
    assert written(cells) == written(listed)
