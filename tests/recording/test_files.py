"""Rows of files: when another begins, which stay, and that nothing is overwritten."""

import io
import resource
from contextlib import contextmanager

import pytest
from click.testing import CliRunner
from recordings import by_mcap, by_rosbags

from jausml.cli import main
from jausml.live.messages import MessageError, load_catalogue
from jausml.live.recording.mcap_files import McapFile, TrafficFilter
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.recording.mcap_records import MAGIC
from jausml.live.recording.recorder import FilePair, RecordingFiles, SplitLimits


def fill(parts, number):
    """Writes so many messages, each into files of its own where the limits say so."""
    for index in range(number):
        file = parts.current.file
        channel = file.ros_channel("/on", "std_msgs/msg/Bool", "bool data")
        file.write(channel, index, b"\0\1\0\0\1")
        parts.current.flush()
        parts.turn()
    parts.current.close()


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_row_by_size_goes_on_where_the_former_one_ended(tmp_path):
    path = tmp_path / "run.mcap"
    fill(RecordingFiles(path, SplitLimits(size=1)), 2)
    assert names(tmp_path) == [
        f"run_{number}.{end}" for number in range(3) for end in ("mcap", "pcap")
    ]
    assert [len(by_mcap(tmp_path / f"run_{number}.mcap")) for number in range(3)] == [1, 1, 0]
    again = RecordingFiles(path, SplitLimits(size=1, files=2), overwrites=True)
    fill(again, 1)
    assert names(tmp_path) == ["run_3.mcap", "run_3.pcap", "run_4.mcap", "run_4.pcap"]
    assert [file.name for file in again.paths] == ["run_3.mcap", "run_4.mcap"]


def test_files_with_dates_are_none_of_a_row(tmp_path):
    theirs = [
        f"run_{date}.{end}" for date in ("20240105", "240105", "0105") for end in ("mcap", "pcap")
    ]
    for name in theirs:
        (tmp_path / name).write_bytes(b"precious")
    fill(RecordingFiles(tmp_path / "run.mcap", SplitLimits(size=1, files=1)), 1)
    assert names(tmp_path) == sorted([*theirs, "run_1.mcap", "run_1.pcap"])


def test_a_row_forgets_its_own_files_whatever_their_numbers(tmp_path):
    (tmp_path / "run_9999.mcap").write_bytes(b"")
    fill(RecordingFiles(tmp_path / "run.mcap", SplitLimits(size=1, files=2)), 3)
    assert names(tmp_path) == [
        f"run_{number}.{end}" for number in (10002, 10003) for end in ("mcap", "pcap")
    ]


def test_a_capture_of_others_is_no_part_of_a_row(tmp_path):
    (tmp_path / "run_0.pcap").write_bytes(b"precious")
    fill(RecordingFiles(tmp_path / "run.mcap", SplitLimits(size=1, files=1)), 2)
    assert names(tmp_path) == ["run_0.pcap", "run_3.mcap", "run_3.pcap"]


def test_two_recorders_of_a_row_take_numbers_in_turn(tmp_path):
    path = tmp_path / "run.mcap"
    rows = [RecordingFiles(path, SplitLimits(size=1)) for _ in range(2)]
    for row in rows:
        fill(row, 2)
    first, second = ([file.name for file in row.paths] for row in rows)
    assert first == ["run_0.mcap", "run_2.mcap", "run_3.mcap"]
    assert second == ["run_1.mcap", "run_4.mcap", "run_5.mcap"]


def test_forged_senders_leave_channels_for_topics():
    stream = io.BytesIO()
    file = McapFile(stream, has_jaus=True)
    beat = load_catalogue().message("ReportHeartbeatPulse")
    for number in range(60_000):
        file.jaus_channel(str(number), beat)
    with pytest.raises(MessageError, match="messages of 60000 kinds and senders"):
        file.jaus_channel("one more", beat)
    channel = file.ros_channel("/on", "std_msgs/msg/Bool", "bool data")
    file.write(channel, 0, b"\0\1\0\0\1")
    file.close()
    assert stream.getvalue().endswith(MAGIC)


def test_without_limits_there_is_one_pair(tmp_path):
    path = tmp_path / "run.mcap"
    fill(RecordingFiles(path, SplitLimits()), 3)
    assert names(tmp_path) == ["run.mcap", "run.pcap"]
    with pytest.raises(FileExistsError):
        RecordingFiles(path, SplitLimits())
    assert len(by_mcap(path)) == 3


@pytest.mark.parametrize(
    ("selection", "wanted"),
    [
        (TrafficFilter(), ["/a", "/a/b", "/c"]),
        (TrafficFilter(topics=("/a*",)), ["/a", "/a/b"]),
        (TrafficFilter(topics=("/a", "/c"), excluded=("/c",)), ["/a"]),
        (TrafficFilter(excluded=("/a/*",)), ["/a", "/c"]),
    ],
)
def test_topics_by_patterns(selection, wanted):
    assert [topic for topic in ("/a", "/a/b", "/c") if selection.wants_topic(topic)] == wanted


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (["a.mcap", "--max-files", "2"], "--max-files needs --max-size or --max-duration"),
        (["."], ". is a folder"),
        (["a.mcap", "--topic", "odom"], "no topic is 'odom': full names begin with /"),
    ],
)
def test_files_that_make_no_sense_are_told(tmp_path, monkeypatch, line, said):
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["record", "--output", *line])
    assert said in result.stderr
    assert result.exit_code == 2
    assert names(tmp_path) == []


@contextmanager
def files_up_to(size):
    """Lets no file grow above so many bytes, as a full disk does."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("room", range(0, 500, 31))
def test_a_file_that_cannot_grow_ends_behind_its_last_whole_record(tmp_path, room):
    path, kept = tmp_path / "run.mcap", 0
    pair = FilePair(path, "none", overwrites=False)

    def record(number):
        nonlocal kept
        for _ in range(number):
            channel = pair.file.ros_channel("/on", "std_msgs/msg/Bool", "bool data")
            pair.file.write(channel, kept, b"\0\1\0\0\1")
            pair.flush()
            kept += 1

    record(3)
    with files_up_to(path.stat().st_size + room), pytest.raises(OSError, match="too large"):
        record(9)
    pair.give_up()
    assert [message.log_time for _, _, message in by_mcap(path)] == list(range(kept))
    whole = McapRecording(str(path))
    assert len(list(whole.messages())) == kept
    assert whole.fault == "its recorder was stopped: what came last may be missing"


def test_a_file_whose_recorder_was_killed_is_opened_by_others(tmp_path):
    path = tmp_path / "run.mcap"
    with path.open("wb") as stream:
        file = McapFile(stream, has_jaus=False)
        file.write(file.ros_channel("/on", "std_msgs/msg/Bool", "bool data"), 7, b"\0\1\0\0\1")
        file.flush()
        assert [(by_rosbag.topic, by_rosbag.time) for by_rosbag in by_rosbags(path)] == [("/on", 7)]
        file.write(file.ros_channel("/on", "std_msgs/msg/Bool", "bool data"), 8, b"\0\1\0\0\1")
        file.close()
    assert [by_rosbag.time for by_rosbag in by_rosbags(path)] == [7, 8]
