"""Flat forms of lists of octets: by a table, where each element depends on its octet alone."""

from __future__ import annotations

import importlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.generators.assignment_support import generated

TEXT = """
cells {
  JAUS SetCells ( uint8 [<=3000] cells ) { code: 0xD111 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . : cost_to_occupancy } )
  ROS->JAUS ( data -> cells { . -> value : occupancy_to_cost { outOfRange: dropMessage } } )
}
plain {
  JAUS SetPlain ( uint8 [<=3000] cells ) { code: 0xD112 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . { outOfRange: clamp } } )
  ROS->JAUS ( data -> cells { . -> value { outOfRange: clamp } } )
}
scaled {
  JAUS SetScaled ( uint8 width  uint8 [<=3000] cells ) { code: 0xD113 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data {
    value, /width -> . : expression("value - width") { outOfRange: clamp }
  } )
}
bridge octet_lists {
  address: 9.9.9
CONNECTIONS
}
"""
WAYS = (("cells", "up"), ("cells", "down"), ("plain", "up"), ("plain", "down"), ("scaled", "up"))
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


def both_forms(bridge, name, way, data):
    """What the flat form and the readable one make of bytes: bytes, or the class of an error."""
    method = getattr(bridge.bridge, f"translate_{name}_{way}")
    flat = method.transcoder(bridge.bridge, getattr(bridge.bridge, f"{name}_{way}"))
    decode = getattr(bridge.messages, f"Set{name.title()}").decode
    light = importlib.import_module(f"{bridge.package}.ros_types").OccupancyGrid

    def readable(data):
        if way == "up":
            return method(decode(data)).to_cdr()
        return method(light.from_cdr(data)).encode()

    return [_outcome(form, data) for form in (flat, readable)]


def _outcome(form, data):
    try:
        return bytes(form(data))
    except Exception as error:
        return type(error).__name__


@given(cells=st.binary(max_size=300), name=st.sampled_from(["cells", "plain"]))
def test_octets_of_jaus_are_the_same_in_both_forms(bridge, cells, name):
    code = {"cells": b"\x11\xd1", "plain": b"\x12\xd1"}[name]
    flat, readable = both_forms(bridge, name, "up", code + len(cells).to_bytes(2, "little") + cells)
    assert flat == readable


@given(cells=st.binary(max_size=300), name=st.sampled_from(["cells", "plain"]))
def test_octets_of_ros_are_the_same_in_both_forms(bridge, cells, name):
    light = importlib.import_module(f"{bridge.package}.ros_types").OccupancyGrid
    message = light(data=[each - 256 * (each > 127) for each in cells])
    flat, readable = both_forms(bridge, name, "down", message.to_cdr())
    assert flat == readable


@given(cells=st.binary(max_size=50), width=st.integers(0, 255))
def test_what_depends_on_more_than_the_octet_is_a_loop(bridge, cells, width):
    head = b"\x13\xd1" + bytes([width]) + len(cells).to_bytes(2, "little")
    flat, readable = both_forms(bridge, "scaled", "up", head + cells)
    assert flat == readable


def test_tables_stand_where_they_can(bridge):
    text = bridge.artifacts["octet_lists/octet_lists/transcoders.py"].text
    for name, way in WAYS:
        function = text.partition(f"def {name}_{way}(")[2].partition("\ndef ")[0]
        assert (".translate(_TABLE" in function) == (name != "scaled"), f"{name}_{way}"


@pytest.mark.parametrize("cells", [b"", b"\x05", b"\xff" * 3001])
def test_short_and_long_lists_are_refused_alike(bridge, cells):
    data = b"\x11\xd1" + (len(cells) + 1).to_bytes(2, "little") + cells
    flat, readable = both_forms(bridge, "cells", "up", data)
    assert flat == readable == "DecodeError"
