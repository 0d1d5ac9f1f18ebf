"""MCAP files that were cut off at any byte: what was flushed is read, and becomes whole again."""

import errno
import io
import time
from contextlib import contextmanager
from functools import cache

import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from recordings import by_mcap, by_rosbags, wait_for

from jausml.cli import main
from jausml.live.recording.bags import Bag
from jausml.live.recording.mcap_files import (
    COMPRESSIONS,
    McapFile,
    RecordingError,
    TimeSpan,
    TrafficFilter,
)
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.recording.recorder import Recorder, RecordingFiles, SplitLimits
from jausml.live.traffic.captures import RAW_IP, CapturedFrame, read_frames

EACH, FLUSHES = 3, 4
SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND


@cache
def recording(compression="zstd"):
    """Returns a file, and how long it was after each time that it was flushed."""
    stream, sizes = io.BytesIO(), []
    file = McapFile(stream, has_jaus=False, compression=compression)
    for flush in range(FLUSHES):
        for number in range(EACH):
            channel = file.ros_channel(f"/on_{flush % 2}", "std_msgs/msg/Bool", "bool data")
            file.write(channel, BEGIN + (flush * EACH + number) * SECOND, b"\0\1\0\0\1")
        file.flush()
        sizes.append(stream.tell())
    file.close()
    return stream.getvalue(), tuple(sizes)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, len(recording()[0]) - 1), st.sampled_from(COMPRESSIONS))
def test_what_was_flushed_is_read(tmp_path, length, compression):
    data, sizes = recording(compression)
    path = tmp_path / "cut.mcap"
    path.write_bytes(data[:length])
    # The indexes of a chunk stand behind it: the chunk is there before they are.
    flushed = EACH * sum(size <= length for size in sizes)
    cut = McapRecording(str(path))
    try:
        found = [message.log_time for _, _, message in cut.messages()]
    except RecordingError:
        assert flushed == 0
        return
    assert found == [BEGIN + number * SECOND for number in range(len(found))]
    assert flushed <= len(found) <= flushed + EACH
    assert cut.reached == found[-1]
    assert cut.fault or length >= len(data)


def test_zeros_at_the_end_are_not_read_as_messages(tmp_path):
    # So files look of which the system knew the length, and the disk not all of the bytes.
    data, sizes = recording()
    path = tmp_path / "cut.mcap"
    path.write_bytes(data[: sizes[1]] + bytes(4096))
    cut = McapRecording(str(path))
    assert len(list(cut.messages())) == 2 * EACH
    assert cut.fault


def test_a_damaged_chunk_is_left_out(tmp_path):
    data, sizes = recording("none")
    path = tmp_path / "cut.mcap"
    damaged = bytearray(data)
    damaged[sizes[0] + 100] ^= 0xFF
    path.write_bytes(damaged[:-100])
    cut = McapRecording(str(path))
    # The chunk that describes the second channel is damaged, and the summary is cut off.
    assert len(list(cut.messages())) == 2 * EACH
    assert f"the chunk at byte {sizes[0]} does not fit its checksum" in cut.fault
    assert f"{EACH} messages are of channel 2, which nothing describes" in cut.fault


@pytest.fixture
def cut(tmp_path):
    """A file that ends in its third chunk."""
    data, sizes = recording()
    path = tmp_path / "cut.mcap"
    path.write_bytes(data[: sizes[1] + 20])
    return path


def test_bags_tell_how_far_they_go(cut):
    bag = Bag(str(cut))
    assert len(list(bag.messages())) == 2 * EACH
    assert bag.reached == BEGIN + 5 * SECOND
    assert "in the midst of a record" in bag.fault


def test_a_bag_without_metadata_is_read_file_by_file(tmp_path):
    # So rosbag2 leaves a bag whose recorder was killed: only the last file is cut off.
    data, sizes = recording()
    for number, length in ((2, len(data)), (10, sizes[0] + 20), (11, 30)):
        (tmp_path / f"run_{number}.mcap").write_bytes(data[:length])
    bag = Bag(str(tmp_path))
    assert len(list(bag.messages())) == EACH * FLUSHES + EACH
    assert "run_11.mcap cannot be read" in bag.fault
    part = Bag(str(tmp_path), TimeSpan(start=10.0))
    assert [message.time for message in part.messages()][:2] == [
        BEGIN + 10 * SECOND,
        BEGIN + 11 * SECOND,
    ]
    for path in tmp_path.glob("run_*.mcap"):
        path.write_bytes(data[:30])
    with pytest.raises(RecordingError, match=r"run_11\.mcap cannot be read"):
        list(Bag(str(tmp_path)).messages())


def test_it_is_made_whole_for_all_who_read_such_files(cut, tmp_path):
    whole = tmp_path / "whole.mcap"
    line = ["replay", str(cut), "--ros-only", "--output", str(whole)]
    result = CliRunner().invoke(main, line)
    assert "it was read until 2023-11-14 22:13:25.000+00:00" in result.stderr
    assert result.exit_code == 1
    expected = [BEGIN + number * SECOND for number in range(2 * EACH)]
    assert [by_rosbag.time for by_rosbag in by_rosbags(whole)] == expected
    assert [message.log_time for _, _, message in by_mcap(whole)] == expected
    again = CliRunner().invoke(main, [*line[:1], str(whole), "-o", str(tmp_path / "again.mcap")])
    assert (again.exit_code, again.stderr) == (0, "6 messages\n")


def test_what_cannot_be_read_makes_no_file(tmp_path):
    path, whole = tmp_path / "cut.mcap", tmp_path / "whole.mcap"
    path.write_bytes(recording()[0][:40])
    result = CliRunner().invoke(main, ["replay", str(path), "-o", str(whole)])
    assert "cut.mcap cannot be read" in result.stderr
    assert result.exit_code == 2
    assert not whole.exists()


@pytest.mark.parametrize(
    ("name", "reason"), [("none.mcap", "No such file or directory"), ("f.mcap", "Is a directory")]
)
def test_what_cannot_be_opened_is_told(tmp_path, name, reason):
    (tmp_path / "f.mcap").mkdir()
    path, whole = tmp_path / name, tmp_path / "whole.mcap"
    result = CliRunner().invoke(main, ["replay", str(path), "-o", str(whole)])
    assert (result.exit_code, result.stderr) == (2, f"Error: {path}: {reason}\n")
    assert not whole.exists()


def test_a_recording_is_not_written_over_itself(cut):
    data = cut.read_bytes()
    result = CliRunner().invoke(main, ["replay", str(cut), "-o", str(cut), "--force"])
    assert "would be written over itself" in result.stderr
    assert (result.exit_code, cut.read_bytes()) == (2, data)


def test_who_wants_a_capture_is_told_where_it_is(cut):
    result = CliRunner().invoke(main, ["decode", "--pcap", str(cut)])
    assert "an MCAP recording, not a capture" in result.stderr
    assert result.exit_code == 1


def test_a_file_that_is_missing_is_told_before_the_model(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["replay", "none.mcap"])
    assert (result.exit_code, result.stderr) == (2, "Error: none.mcap: No such file or directory\n")


def test_a_folder_without_a_model_is_told_to_hold_files(tmp_path):
    line = ["replay", str(tmp_path), "--ros-only", "--output", str(tmp_path / "whole.mcap")]
    result = CliRunner().invoke(main, line)
    assert result.exit_code == 2
    assert "is no MCAP file: name one that is in a bag, or make one by `ros2 bag" in result.stderr


def broken():
    raise OSError(errno.ENOSPC, "No space left on device")


@contextmanager
def recorded(path, limits, **broken_methods):
    """Yields a recorder, its files, and a function that gives it frames, until a fault."""
    parts = RecordingFiles(path, limits)
    vars(parts).update(broken_methods)
    recorder = Recorder(parts, None, {}, TrafficFilter())
    frame = CapturedFrame(1, 1.0, RAW_IP, b"E", nanoseconds=SECOND)

    def take(count):
        for _ in range(count):
            recorder.take_frame(frame, None)

    with recorder.kept(0.001, lambda: None):
        yield recorder, parts, take
        wait_for(lambda: recorder.fault is not None, "fault")


def captured(path):
    return len(list(read_frames(io.BytesIO(path.with_suffix(".pcap").read_bytes()))))


def test_a_full_disk_is_told_with_what_it_took(tmp_path):
    path = tmp_path / "run.mcap"
    with recorded(path, SplitLimits()) as (recorder, parts, take):
        take(5)
        wait_for(lambda: recorder.lost == 0 and recorder.reached, "five frames on the disk")
        parts.current.flush = broken
        full = time.time()
        take(4)
    assert captured(path) == 5
    assert recorder.lost == 4
    assert recorder.reached <= full


def test_a_file_that_is_complete_stays_so_where_the_next_one_has_no_room(tmp_path):
    limits = SplitLimits(duration=0.0)
    with recorded(tmp_path / "run.mcap", limits, _further=broken) as (_, parts, take):
        take(9)
    (path,) = parts.paths
    whole = McapRecording(str(path))
    assert list(whole.messages()) == []
    assert whole.fault == ""
    assert captured(path) > 0
