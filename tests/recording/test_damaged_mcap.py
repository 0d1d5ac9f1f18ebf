"""MCAP files that are damaged within, or say less of themselves than usual, or too much."""

import io
import struct

import pytest
import zstandard
from click.testing import CliRunner
from mcap.writer import CompressionType, IndexType, Writer

from jausml.cli import main
from jausml.live.recording import mcap_reading
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.mcap_reading import McapRecording

COUNT = 40


def recording(compression=CompressionType.NONE, count=COUNT, **options):
    """Returns an MCAP file of several chunks, each with a few texts on two topics."""
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=300, compression=compression, **options)
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data\n")
    channels = [writer.register_channel(f"/talk_{name}", "cdr", schema) for name in "ab"]
    for number in range(count):
        text = f"speed limit {number:03}".encode() + b"\0"
        data = b"\0\1\0\0" + struct.pack("<I", len(text)) + text
        writer.add_message(channels[number % 2], number, data, number)
    writer.finish()
    return stream.getvalue()


def read(tmp_path, data):
    """Returns times of messages, and what is not read."""
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    found = McapRecording(str(path))
    return [message.log_time for _, _, message in found.messages()], found.fault


def flipped(data, text=b"speed limit 015"):
    """Returns a file with other letters in a text."""
    assert data.count(text) == 1
    return data.replace(text, text.upper())


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"index_types": IndexType.NONE},
        {"use_statistics": False},
        {"use_summary_offsets": False, "repeat_channels": False},
        {"repeat_schemas": False},
        {"repeat_channels": False, "repeat_schemas": False, "use_statistics": False},
        {"repeat_channels": False, "index_types": IndexType.CHUNK, "use_statistics": False},
    ],
)
@pytest.mark.parametrize("compression", list(CompressionType))
def test_valid_files_of_any_form_are_read(tmp_path, compression, options):
    assert read(tmp_path, recording(compression, **options)) == (list(range(COUNT)), "")


@pytest.mark.parametrize("index", [IndexType.ALL, IndexType.NONE])
def test_a_damaged_chunk_is_left_out_and_told_whichever_way_leads_to_it(tmp_path, index):
    found, fault = read(tmp_path, flipped(recording(index_types=index)))
    assert 15 not in found
    assert {0, 1, COUNT - 1} <= set(found)
    assert "does not fit its checksum" in fault
    assert f"{len(found)} of the {COUNT} messages that it counts are read" in fault


def test_a_chunk_of_which_the_head_is_damaged_is_told(tmp_path):
    data = bytearray(recording())
    at = data.find(b"speed limit 015")
    data[at - 120 : at + 50] = bytes(170)
    found, fault = read(tmp_path, bytes(data))
    assert {0, COUNT - 1} <= set(found)
    assert f"{len(found)} of the {COUNT} messages" in fault


def test_many_damages_are_counted(tmp_path):
    data = recording()
    for number in range(0, COUNT, 3):
        data = data.replace(b"limit %03d" % number, b"LIMIT %03d" % number)
    with pytest.raises(RecordingError, match=r"[1-9] more places are damaged"):
        read(tmp_path, data)


def test_a_file_without_chunks_is_held_against_its_checksum(tmp_path):
    data = recording(use_chunking=False, enable_data_crcs=True)
    assert read(tmp_path, data)[1] == ""
    assert "before its end does not fit its checksum" in read(tmp_path, flipped(data))[1]


@pytest.mark.parametrize("held", [1 << 28, 0])
def test_messages_come_in_the_order_of_their_times_wherever_they_stand(tmp_path, monkeypatch, held):
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=300)
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/Bool", "ros2msg", b"bool data\n")
    channel = writer.register_channel("/on", "cdr", schema)
    for number in range(COUNT):
        writer.add_message(channel, number * 7 % COUNT, b"\0\1\0\0\1" * 9, number)
    writer.finish()
    # Where chunks would fill the memory, what is at hand comes before others are unpacked.
    monkeypatch.setattr(mcap_reading, "MOST_UNPACKED", max(held, 1 << 11))
    found, fault = read(tmp_path, stream.getvalue())
    assert (sorted(found), fault) == (list(range(COUNT)), "")
    assert (found == sorted(found)) is bool(held)


def test_a_damaged_summary_is_not_used(tmp_path):
    data = bytearray(recording())
    data[-60] ^= 1
    found, fault = read(tmp_path, bytes(data))
    assert (found, fault) == (list(range(COUNT)), "its summary does not fit its checksum")


def test_statistics_that_count_more_are_told(tmp_path):
    data = recording(enable_crcs=False)
    counted = struct.pack("<BQQ", 0x0B, 46 + 2 * 10, COUNT)
    assert data.count(counted) == 1
    found, fault = read(tmp_path, data.replace(counted, counted[:-8] + struct.pack("<Q", 99)))
    assert found == list(range(COUNT))
    assert fault == f"{COUNT} of the 99 messages that it counts are read"


def test_an_index_that_leads_to_one_chunk_again_and_again_gives_it_once(tmp_path):
    data = recording(enable_crcs=False, use_statistics=False)
    first = data.find(b"\x06")
    entry = struct.pack("<B", 0x08)
    begin = data.rfind(entry + struct.pack("<Q", 8 * 4 + 4 + 20 + 8 + 4 + 16))
    assert 0 < first < begin
    size = 9 + 8 * 4 + 4 + 20 + 8 + 4 + 16
    more = data[begin : begin + size] * 3
    assert len(read(tmp_path, data[:begin] + more + data[begin:])[0]) == COUNT


def bomb(stated, made):
    """Returns a file with one chunk that says a size, and unpacks to another."""
    packed = zstandard.compress(bytes(made) if isinstance(made, int) else made)
    head = struct.pack("<QQQI", 0, 0, stated, 0) + struct.pack("<I", 4) + b"zstd"
    chunk = head + struct.pack("<Q", len(packed)) + packed
    whole = recording(count=1, use_chunking=False)
    end = whole.rfind(b"\x0f\x04\0\0\0\0\0\0\0")
    return whole[:end] + struct.pack("<BQ", 6, len(chunk)) + chunk + whole[end:]


@pytest.mark.parametrize(
    ("stated", "made", "said"),
    [
        (1 << 30, 1 << 10, "unpacks to 1,073,741,824 bytes; 268,435,456 are read at most"),
        (1 << 10, 1 << 24, "unpacks to more than 1,024 bytes"),
        (1 << 10, 1 << 9, "has 512 of 1,024 bytes"),
        (1 << 20, 1 << 20, "holds what is no record"),
        ((1 << 64) - 1, 1 << 10, "unpacks to 18,446,744,073,709,551,615 bytes"),
    ],
)
def test_a_chunk_that_unpacks_to_other_than_it_says_is_refused(tmp_path, stated, made, said):
    found, fault = read(tmp_path, bomb(stated, made))
    assert found == [0]
    assert said in fault


def test_more_messages_than_so_small_a_file_can_have_are_refused(tmp_path):
    count = (1 << 18) + 1
    messages = (struct.pack("<BQ", 5, 22) + bytes(22)) * count
    found, fault = read(tmp_path, bomb(len(messages), messages))
    assert found == [0]
    assert "holds more than 262,144 messages, which a file of " in fault


@pytest.mark.parametrize("at", range(8, 400, 13))
def test_no_text_of_a_library_reaches_a_user(tmp_path, at):
    data = bytearray(recording())
    data[at : at + 9] = b"\xff" * 9
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    made = tmp_path / "again.mcap"
    result = CliRunner().invoke(main, ["replay", str(path), "-o", str(made)])
    said = result.stderr.replace(str(tmp_path), "")
    assert not any(word in said for word in ("index-sized", "codec", "unpack requires", "'int'"))
    assert result.exit_code in ((0, 1) if made.exists() else (2,)), said


def test_replay_tells_damage_and_ends_with_1(tmp_path):
    path = tmp_path / "run.mcap"
    path.write_bytes(flipped(recording()))
    result = CliRunner().invoke(main, ["replay", str(path), "-o", str(tmp_path / "again.mcap")])
    assert result.exit_code == 1
    assert "run.mcap is not whole: the chunk at byte" in result.stderr
