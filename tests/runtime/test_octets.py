"""Lists of small numbers as bytes, against the conversions of lists."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.bridge.messages import octets
from jausml.runtime.conversions import ConversionError
from jausml.runtime.conversions.rasters import occupancy_to_cost, reverse_rows


@given(st.binary(max_size=40), st.sampled_from([0, 1, 2, 3, 7, 2.5, -1, 40]))
def test_rows_are_reversed_as_those_of_lists(cells, columns):
    try:
        expected = bytes(reverse_rows(cells, columns))
    except ConversionError:
        with pytest.raises(ConversionError):
            octets.reverse_rows(bytearray(cells), columns)
    else:
        assert octets.reverse_rows(bytearray(cells), columns) == expected


def test_a_table_has_what_the_function_gives():
    table = octets.Table(occupancy_to_cost, 0, 255, is_signed=True)
    legal = [*range(101), 255]
    assert table.odd is not None
    assert [octet for octet in range(256) if table.octets[octet] != table.odd] == legal
    for octet in legal:
        value = octet - 256 if octet > 127 else octet
        assert table.octets[octet] == occupancy_to_cost(value)


def test_values_outside_do_not_fit():
    table = octets.Table(lambda value: value * 0.5, -10, 10, is_signed=True)
    odd = {octet for octet in range(256) if table.octets[octet] == table.odd}
    assert odd == set(range(256)) - {number & 0xFF for number in range(-20, 21)}
    assert bytes([251, 5]).translate(table.octets) == bytes([254, 2])


def test_a_table_of_all_octets_has_nothing_to_look_for():
    table = octets.Table(lambda value: 255 - value, 0, 255, is_signed=False)
    assert table.odd is None
    assert bytes([0, 7, 255]).translate(table.octets) == bytes([255, 248, 0])


def test_one_octet_without_a_value_is_found():
    table = octets.Table(lambda value: value, 1, 255, is_signed=False)
    assert table.odd == 0
    assert table.odd in bytes([3, 0, 5]).translate(table.octets)
    assert table.odd not in bytes(range(1, 256)).translate(table.octets)
