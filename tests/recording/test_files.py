"""Rows of files: when another begins, which stay, and that nothing is overwritten."""

from __future__ import annotations

import pytest
from click.testing import CliRunner
from recordings import by_mcap

from jausml.cli import main
from jausml.live.recording.mcap_files import TrafficFilter
from jausml.live.recording.recorder import RecordingFiles, SplitLimits


def fill(parts, number):
    """Writes so many messages, each into files of its own where the limits say so."""
    for each in range(number):
        file = parts.current.file
        channel = file.ros_channel("/on", "std_msgs/msg/Bool", "bool data")
        file.write(channel, each, b"\0\1\0\0\1")
        parts.current.flush()
        parts.turn()
    parts.current.close()


def names(folder):
    return sorted(each.name for each in folder.iterdir())


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
    assert [each.name for each in again.paths] == ["run_3.mcap", "run_4.mcap"]


def test_two_recorders_of_a_row_take_numbers_in_turn(tmp_path):
    path = tmp_path / "run.mcap"
    rows = [RecordingFiles(path, SplitLimits(size=1)) for _ in range(2)]
    for row in rows:
        fill(row, 2)
    first, second = ([each.name for each in row.paths] for row in rows)
    assert first == ["run_0.mcap", "run_2.mcap", "run_3.mcap"]
    assert second == ["run_1.mcap", "run_4.mcap", "run_5.mcap"]


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
    assert [each for each in ("/a", "/a/b", "/c") if selection.wants_topic(each)] == wanted


def test_limits_that_make_no_sense_are_told(tmp_path):
    line = ["record", "--output", str(tmp_path / "a.mcap"), "--max-files", "2"]
    result = CliRunner().invoke(main, line)
    assert "--max-files needs --max-size or --max-duration" in result.stderr
    assert result.exit_code == 2
    assert names(tmp_path) == []
