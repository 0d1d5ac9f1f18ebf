"""Recordings of ROS that are none, or were damaged: each is told, whatever the libraries raise."""

from __future__ import annotations

import io
from contextlib import suppress

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import Writer

from jausml.live.recording.bags import Bag
from jausml.live.recording.mcap_files import RecordingError


def recording():
    """Returns an MCAP file of three messages."""
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/Bool", "ros2msg", b"bool data")
    channel = writer.register_channel("/on", "cdr", schema)
    for number in range(3):
        writer.add_message(channel, number, b"\0\1\0\0\1", number)
    writer.finish()
    return stream.getvalue()


WHOLE = recording()


def test_a_whole_one_is_read(tmp_path):
    path = tmp_path / "run.mcap"
    path.write_bytes(WHOLE)
    assert [(each.topic, each.time) for each in Bag(str(path)).messages()] == [
        ("/on", 0),
        ("/on", 1),
        ("/on", 2),
    ]


@pytest.mark.parametrize("name", ["run.mcap", "run.db3", "folder"])
def test_what_is_no_recording_is_told(tmp_path, name):
    path = tmp_path / name
    if name == "folder":
        path.mkdir()
        path = path / "metadata.yaml"
    path.write_bytes(b"junk")
    path = tmp_path / name
    with pytest.raises(RecordingError, match=f"{name}.* cannot be read: ."):
        list(Bag(str(path)).messages())


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    places=st.lists(st.tuples(st.integers(0, len(WHOLE) - 1), st.integers(0, 255)), max_size=4),
    length=st.integers(0, len(WHOLE)),
)
def test_a_damaged_one_is_read_or_told(tmp_path, places, length):
    data = bytearray(WHOLE)
    for place, value in places:
        data[place] = value
    path = tmp_path / "run.mcap"
    path.write_bytes(data[:length])
    with suppress(RecordingError):
        assert len(list(Bag(str(path)).messages())) <= 3
