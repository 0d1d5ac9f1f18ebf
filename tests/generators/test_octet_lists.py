"""Lists of octets, which a table translates where each element depends on its octet alone."""

import importlib
from functools import partial

import needs
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.generators.assignment_support import generated

TEXT = """
cells { JAUS SetCells ( uint8 [<=3000] cells ) { code: 0xD111 }  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . : cost_to_occupancy } )
  ROS->JAUS ( data -> cells { . -> value : occupancy_to_cost { outOfRange: dropMessage } } )
}
plain { JAUS SetPlain ( uint8 [<=3000] cells ) { code: 0xD112 }  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . { outOfRange: clamp } } )
  ROS->JAUS ( data -> cells { . -> value { outOfRange: clamp } } )
}
scaled { JAUS SetScaled ( uint8 width  uint8 [<=3000] cells ) { code: 0xD113 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data {
    value, /width -> . : expression("value - width") { outOfRange: clamp }
  } )
}
shares { JAUS SetShares ( uint8 [<=3000] cells { lower: 0  upper: 100 } ) { code: 0xD114 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . : square_root { outOfRange: clamp } } )
}
bridge octet_lists { address: 9.9.9  CONNECTIONS }
"""
WAYS = (
    ("cells", "up"),
    ("cells", "down"),
    ("plain", "up"),
    ("plain", "down"),
    ("scaled", "up"),
    ("shares", "up"),
)
DIRECTIONS = {"up": "jausToRos", "down": "rosToJaus"}


@pytest.fixture(scope="module")
def bridge(tmp_path_factory):
    """The bridge of the maps, generated and imported."""
    lines = [
        f"  connection {name}_{way} {{ map: {name}  direction: {DIRECTIONS[way]}  exchange: message"
        f"  topic {name}_{way} }}"
        for name, way in WAYS
    ]
    text = TEXT.replace("CONNECTIONS", "\n".join(lines))
    return generated(text, tmp_path_factory.mktemp("octets"), "octet_lists")


def both_ways(bridge, name, way, data):
    """What is made of bytes by a list as a whole and by each octet: bytes, or class of an error.

    In objects that somebody has put together, a list is a list.
    """
    method = getattr(bridge.bridge, f"translate_{name}_{way}")
    decode = getattr(bridge.messages, f"Set{name.title()}").decode
    light = importlib.import_module(f"{bridge.package}.ros_types").OccupancyGrid

    def translated(data, change):
        if way == "up":
            source = decode(data)
            source.cells = change(source.cells)
            return method(source).to_cdr()
        source = light.from_cdr(data)
        source.data = change(source.data)
        return method(source).encode()

    return [_outcome(partial(translated, change=change), data) for change in (_same, list)]


def _same(items):
    return items


def _outcome(form, data):
    try:
        return bytes(form(data))
    except Exception as error:
        return type(error).__name__


@given(cells=st.binary(max_size=300), name=st.sampled_from(["cells", "plain"]))
def test_octets_of_jaus_are_the_same_in_both_ways(bridge, cells, name):
    code = {"cells": b"\x11\xd1", "plain": b"\x12\xd1"}[name]
    whole, listed = both_ways(bridge, name, "up", code + len(cells).to_bytes(2, "little") + cells)
    assert whole == listed


@given(cells=st.binary(max_size=300), name=st.sampled_from(["cells", "plain"]))
def test_octets_of_ros_are_the_same_in_both_ways(bridge, cells, name):
    light = importlib.import_module(f"{bridge.package}.ros_types").OccupancyGrid
    message = light(data=[cell - 256 * (cell > 127) for cell in cells])
    whole, listed = both_ways(bridge, name, "down", message.to_cdr())
    assert whole == listed


@pytest.fixture(scope="module")
def compiled(bridge):
    """Returns the compiled translations by connection."""
    needs.ask("compiler")
    bridge.build()
    return {f"{name}_{way}": bridge.compiled(f"{name}_{way}") for name, way in WAYS}


CODES = {"cells": b"\x11\xd1", "plain": b"\x12\xd1", "shares": b"\x14\xd1"}


@pytest.mark.slow
@given(cells=st.binary(max_size=300), name=st.sampled_from([*CODES]))
def test_octets_of_jaus_are_the_same_compiled(bridge, compiled, cells, name):
    data = CODES[name] + len(cells).to_bytes(2, "little") + cells
    whole, _ = both_ways(bridge, name, "up", data)
    found = compiled[f"{name}_up"](data)
    # What is limited, or refused, is Python's.
    assert found == whole or (found is None and is_unusual(cells, name))


def is_unusual(cells, name):
    return name == "plain" and any(cell > 127 for cell in cells)


@pytest.mark.slow
@given(
    cells=st.lists(st.integers(-128, 127), max_size=300), name=st.sampled_from(["cells", "plain"])
)
def test_octets_of_ros_are_the_same_compiled(bridge, compiled, cells, name):
    light = importlib.import_module(f"{bridge.package}.ros_types").OccupancyGrid
    data = light(data=cells).to_cdr()
    whole, _ = both_ways(bridge, name, "down", data)
    found = compiled[f"{name}_down"](data)
    limits = {"cells": range(-1, 101), "plain": range(128)}[name]
    assert (found is None) == any(cell not in limits for cell in cells)
    assert found is None or found == whole


@given(cells=st.binary(max_size=50), width=st.integers(0, 255))
def test_what_depends_on_more_than_the_octet_is_a_loop(bridge, cells, width):
    head = b"\x13\xd1" + bytes([width]) + len(cells).to_bytes(2, "little")
    whole, listed = both_ways(bridge, "scaled", "up", head + cells)
    assert whole == listed


def test_tables_stand_where_they_can(bridge):
    for name, way in WAYS:
        method = bridge.base.partition(f"def translate_{name}_{way}(")[2].partition("\n    def ")[0]
        assert ("octets.each(" in method) == (name == "cells"), f"{name}_{way}"


@pytest.mark.parametrize("cells", [b"", b"\x05", b"\xff" * 3001])
def test_short_and_long_lists_are_refused_alike(bridge, cells):
    data = b"\x11\xd1" + (len(cells) + 1).to_bytes(2, "little") + cells
    whole, listed = both_ways(bridge, "cells", "up", data)
    assert whole == listed == "DecodeError"


def test_a_scaled_octet_is_a_value_and_no_number_of_a_table(bridge):
    data = b"\x14\xd1" + b"\x02\x00" + b"\xff\x00"
    source = bridge.messages.SetShares.decode(data)
    made = bridge.bridge.translate_shares_up(source)
    assert list(made.data) == [10, 0]  # 255 stands for 100
