import copy

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.address import BROADCAST, JausAddress, address_of

ADDRESSES = st.builds(JausAddress, st.integers(0, 65535), st.integers(0, 255), st.integers(0, 255))


def test_the_number_has_the_subsystem_in_its_upper_half():
    assert JausAddress(200, 1, 2).packed == 0x00C80102


@given(ADDRESSES)
def test_every_form_can_be_read_back(address):
    assert JausAddress.parse(str(address)) == address
    assert address_of(address.packed) == address
    assert hash(address_of(address.packed)) == hash(address)


@pytest.mark.parametrize(
    "text", ["", "1.2", "1.2.3.4", "65536.1.1", "1.256.1", "-1.1.1", "1.1.x", "1. 1.1", "١.1.1"]
)
def test_other_text_is_refused(text):
    with pytest.raises(ValueError, match="JAUS address"):
        JausAddress.parse(text)


@pytest.mark.parametrize("parts", [(65536, 1, 1), (1, 256, 1), (1, 1, 256), (-1, 1, 1)])
def test_parts_that_the_wire_cannot_carry_are_refused(parts):
    with pytest.raises(ValueError, match="out of range"):
        JausAddress(*parts)


def test_addresses_sort_by_subsystem_node_component():
    ordered = [JausAddress(1, 2, 3), JausAddress(1, 3, 1), JausAddress(2, 1, 1)]
    shuffled = [ordered[2], ordered[0], ordered[1]]
    assert sorted(shuffled) == ordered


@given(ADDRESSES, ADDRESSES)
def test_a_wildcard_stands_for_every_value_of_its_part(pattern, other):
    expected = (
        pattern.subsystem in (65535, other.subsystem)
        and pattern.node in (255, other.node)
        and pattern.component in (255, other.component)
    )
    assert pattern.matches(other) is expected
    assert BROADCAST.matches(other)


@pytest.mark.parametrize(
    ("text", "wildcard", "concrete"),
    [
        ("1.1.1", False, True),
        ("65534.254.254", False, True),
        ("65535.1.1", True, False),
        ("1.255.1", True, False),
        ("1.1.255", True, False),
        ("0.1.1", False, False),
        ("1.0.1", False, False),
        ("1.1.0", False, False),
        ("0.0.255", True, False),
    ],
)
def test_zero_is_reserved_and_all_ones_is_a_wildcard(text, wildcard, concrete):
    address = JausAddress.parse(text)
    assert (address.is_wildcard, address.is_concrete) == (wildcard, concrete)


@given(ADDRESSES)
def test_an_address_is_its_number_and_stays_an_address(address):
    assert {address: 1}[address.packed] == 1
    assert type(address.packed) is int
    assert address
    copied = copy.deepcopy(address)
    assert (type(copied), str(copied)) == (JausAddress, str(address))
    assert f"{address}" == ".".join(map(str, address.__getnewargs__()))
    assert repr(address) == f"JausAddress{address.__getnewargs__()}"
