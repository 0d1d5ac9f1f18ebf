"""Recordings of ROS that are none, or were damaged: each is told, whatever the libraries raise."""

import io
import sqlite3
from contextlib import closing, suppress

import pytest
import yaml
import zstandard
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.writer import Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

from jausml.live.recording.bags import Bag
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.unpacking import MOST_UNPACKED


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
    assert [(message.topic, message.time) for message in Bag(str(path)).messages()] == [
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


TEXT = "std_msgs/msg/String"
COUNT = 5


def bag(path, storage, compression=None):
    """Writes a bag of rosbag2."""
    types = get_typestore(Stores.ROS2_JAZZY)
    writer = BagWriter(path, version=9, storage_plugin=storage)
    if compression is not None:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        topic = writer.add_connection("/talk", TEXT, typestore=types)
        for number in range(COUNT):
            text = types.types[TEXT](data=f"text {number}")
            writer.write(topic, number, types.serialize_cdr(text, TEXT))
    return path


def change(path, edit):
    """Changes what the metadata of a bag says."""
    metadata = path / "metadata.yaml"
    whole = yaml.safe_load(metadata.read_text())
    edit(whole["rosbag2_bagfile_information"])
    metadata.write_text(yaml.safe_dump(whole))


def times(path):
    found = Bag(str(path))
    return [message.time for message in found.messages()], found.fault


STORAGES = pytest.mark.parametrize("storage", list(StoragePlugin))


@STORAGES
def test_topics_are_those_of_the_files_whatever_metadata_says_of_them(tmp_path, storage):
    path = bag(tmp_path / "run", storage)

    def edit(stated):
        profile = {
            "history": "keep_last",
            "depth": 1,
            "reliability": "reliable",
            "durability": "transient_local",
            **{policy: {"sec": 0, "nsec": 0} for policy in ("deadline", "lifespan")},
            "liveliness_lease_duration": {"sec": 0, "nsec": 0},
            "liveliness": "automatic",
            "avoid_ros_namespace_conventions": False,
        }
        topic = stated["topics_with_message_count"][0]["topic_metadata"]
        topic["offered_qos_profiles"] = [profile]

    change(path, edit)
    assert times(path) == (list(range(COUNT)), "")


@STORAGES
def test_messages_that_metadata_counts_and_no_file_has_are_told(tmp_path, storage):
    path = bag(tmp_path / "run", storage)
    change(path, lambda stated: stated.update(message_count=COUNT + 2))
    assert times(path) == (list(range(COUNT)), "metadata.yaml counts 7 messages, and 5 are read")


@STORAGES
def test_files_that_metadata_names_and_that_are_missing_are_told(tmp_path, storage):
    path = bag(tmp_path / "run", storage)
    change(path, lambda stated: stated["relative_file_paths"].insert(0, "run_0.db3"))
    found, fault = times(path)
    assert found == list(range(COUNT))
    assert "run_0.db3: No such file or directory" in fault


@STORAGES
def test_a_bag_whose_recorder_was_killed_is_read_without_metadata(tmp_path, storage):
    path = bag(tmp_path / "run", storage)
    (path / "metadata.yaml").unlink()
    assert times(path) == (list(range(COUNT)), "")


def test_what_a_killed_recorder_left_beside_a_database_is_told(tmp_path):
    path = bag(tmp_path / "run", StoragePlugin.SQLITE3)
    (path / "run.db3-wal").write_bytes(b"pages")
    assert "what stands in run.db3-wal is not read" in times(path)[1]


@STORAGES
def test_definitions_stand_beside_the_messages(tmp_path, storage):
    path = bag(tmp_path / "run", storage)
    definitions = {message.definition for message in Bag(str(path)).messages()}
    assert {
        (definition.encoding, definition.text.split()[:2] == ["string", "data"])
        for definition in definitions
    } == {("ros2msg", True)}


@pytest.mark.parametrize("compression", [CompressionMode.MESSAGE, CompressionMode.FILE])
def test_compressed_bags_are_read(tmp_path, compression):
    path = bag(tmp_path / "run", StoragePlugin.SQLITE3, compression)
    assert times(path) == (list(range(COUNT)), "")


def test_a_message_that_unpacks_to_too_much_is_refused(tmp_path):
    path = bag(tmp_path / "run", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    with closing(sqlite3.connect(path / "run.db3")) as database:
        packed = zstandard.compress(bytes(MOST_UNPACKED + 1))
        database.execute("UPDATE messages SET data = ? WHERE timestamp = 3", (packed,))
        database.commit()
    found, fault = times(path)
    assert found == [0, 1, 2]
    assert "a message of /talk unpacks to more than 268,435,456 bytes" in fault


def test_a_file_that_unpacks_out_of_proportion_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("jausml.live.recording.unpacking.MOST_UNPACKED", 1 << 20)
    path = bag(tmp_path / "run", StoragePlugin.SQLITE3, CompressionMode.FILE)
    packer = zstandard.ZstdCompressor().compressobj()  # without its size in its head
    (path / "run.db3.zstd").write_bytes(packer.compress(bytes(1 << 22)) + packer.flush())
    with pytest.raises(RecordingError, match=r"unpacks to more than 1,048,576 bytes"):
        list(Bag(str(path)).messages())


def test_a_file_of_several_frames_is_read_whole(tmp_path):
    path = bag(tmp_path / "run", StoragePlugin.SQLITE3, CompressionMode.FILE)
    file = path / "run.db3.zstd"
    contents = zstandard.ZstdDecompressor().stream_reader(file.read_bytes()).read()
    middle = len(contents) // 2  # parallel compressors write a frame for each part
    parts = (contents[:middle], contents[middle:])
    file.write_bytes(b"".join(zstandard.compress(part) for part in parts))
    assert times(path) == (list(range(COUNT)), "")


@pytest.mark.parametrize("states_its_size", [True, False])
def test_a_file_that_ends_in_the_midst_of_a_frame_is_refused(tmp_path, states_its_size):
    path = bag(tmp_path / "run", StoragePlugin.SQLITE3, CompressionMode.FILE)
    file = path / "run.db3.zstd"
    contents = zstandard.ZstdDecompressor().stream_reader(file.read_bytes()).read()
    packer = zstandard.ZstdCompressor(write_content_size=states_its_size)
    file.write_bytes(packer.compress(contents)[:-10])
    with pytest.raises(RecordingError, match="ends in the midst of a frame of zstd"):
        list(Bag(str(path)).messages())
