"""Replays: which part, at which pace, and what somebody at the terminal sees and presses."""

from pathlib import Path
from threading import Event, Thread
from types import SimpleNamespace

import pytest
import warm
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from mcap.writer import Writer
from ports import free_port
from recordings import by_mcap, by_rosbags, frame, nano_pcap, velocity
from terminal import at_terminal

from jausml.cli import main
from jausml.live.recording import to_wire
from jausml.live.recording.bags import Bag, RosMessage
from jausml.live.recording.mcap_files import TimeSpan
from jausml.live.recording.to_wire import ReplayPace

ROOT = Path(__file__).resolve().parents[2]
FLEET = str(ROOT / "models" / "examples" / "fleet" / "fleet.ros2jaus")
MAPS = str(ROOT / "models" / "library" / "mappings" / "velocity_state_sensor.ros2jaus")
SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
STOPS = st.one_of(st.none(), st.floats(0, 20))


def messages(*seconds):
    return [
        RosMessage("/on", "std_msgs/msg/Bool", BEGIN + round(offset * SECOND), b"")
        for offset in seconds
    ]


def bag(path, count):
    """Writes a file with a message each second."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2")
        schema = writer.register_schema("nav_msgs/msg/Odometry", "ros2msg", b"")
        channel = writer.register_channel("/odom", "cdr", schema)
        for number in range(count):
            writer.add_message(channel, BEGIN + number * SECOND, b"\0\1\0\0" + bytes(720), 0)
        writer.finish()
    return str(path)


@given(st.lists(st.one_of(st.none(), st.integers(0, 20))), st.floats(0, 20), STOPS)
def test_a_span_has_what_lies_in_it(seconds, start, duration):
    timed = sorted(moment for moment in seconds if moment is not None)
    found = TimeSpan(start, duration).of(timed, lambda moment: (7 + moment) * SECOND)
    end = float("inf") if duration is None else start + duration
    since = [moment - timed[0] for moment in timed]
    assert [moment - timed[0] for moment in found] == [
        offset for offset in since if offset >= start and offset - start < end - start
    ]


def test_what_nobody_timed_is_in_every_span():
    assert list(TimeSpan(5.0, 1.0).of([None, None], lambda none_type: none_type)) == [None, None]


def test_a_whole_recording_has_what_came_after_its_clock_was_set_back():
    assert list(TimeSpan().of([7, 8, 3, 4], lambda second: second * SECOND)) == [7, 8, 3, 4]


def test_a_part_of_a_recording(tmp_path):
    path, part = bag(tmp_path / "run.mcap", 10), tmp_path / "part.mcap"
    line = ["replay", path, "--start", "2", "--duration", "3", "-o", str(part)]
    result = CliRunner().invoke(main, line)
    assert (result.exit_code, result.stderr) == (0, "3 messages\n")
    times = [message.log_time for _, _, message in by_mcap(part)]
    assert times == [BEGIN + number * SECOND for number in (2, 3, 4)]
    assert Bag(path, TimeSpan(2.0, 3.0)).length() == 3.0
    assert Bag(path, TimeSpan(7.0)).length() == 2.0


def test_a_part_of_a_capture(tmp_path):
    capture, part = tmp_path / "run.pcap", tmp_path / "part.mcap"
    frames = [frame(velocity(float(number), 0.0, 0.0)) for number in range(10)]
    capture.write_bytes(nano_pcap(frames, step=SECOND))
    line = ["replay", str(capture), MAPS, "--start", "7.5", "-o", str(part)]
    assert CliRunner().invoke(main, line).exit_code == 0
    speeds = [
        round(by_rosbag.message.twist.twist.linear.x, 4)
        for by_rosbag in by_rosbags(part)
        if "Odometry" in type(by_rosbag.message).__name__
    ]
    assert speeds == [8.0, 9.0]


def test_nothing_passes_in_a_pause():
    stop, passed = Event(), []
    pace = ReplayPace(100.0, 1000.0, stop)
    pace.is_paused = True
    reader = Thread(target=lambda: passed.extend(pace.messages(messages(0, 1, 2))))
    reader.start()
    try:
        reader.join(0.3)
        assert reader.is_alive()
        assert passed == []
        pace.is_paused = False
        reader.join(60)
        assert [message.time for message in passed] == [BEGIN, BEGIN + SECOND, BEGIN + 2 * SECOND]
        assert pace.position == 2.0
    finally:
        stop.set()
        reader.join(60)


def test_what_comes_faster_than_anybody_can_take_it_is_late(monkeypatch):
    now = [0.0]

    class Clock(Event):
        def wait(self, timeout=None):
            now[0] += timeout
            return False

    monkeypatch.setattr(to_wire, "time", SimpleNamespace(monotonic=lambda: now[0]))
    pace = ReplayPace(1.0, 4.0, Clock())
    times = [now[0] for _ in pace.messages(messages(0, 0, 0, 2))]
    assert times == pytest.approx([0.0, 0.25, 0.5, 2.0])


def test_the_end_comes_in_the_midst_of_waiting():
    stop = Event()
    passed = []
    pace = ReplayPace(1.0, 1000.0, stop)
    for message in pace.messages(messages(0, 3600)):
        passed.append(message)
        stop.set()
    assert len(passed) == 1


@pytest.mark.live
@pytest.mark.ports
def test_a_loop_gives_all_again(tmp_path):
    path = bag(tmp_path / "run.mcap", 2)
    options = ["--port", str(free_port()), "--wait", "0", "--hold", "0", "--speed", "100"]
    result = CliRunner().invoke(main, ["replay", path, FLEET, "--loop", "--count", "5", *options])
    assert result.exit_code == 0, result.stderr
    assert "5 of /odom" in result.stderr
    empty = bag(tmp_path / "empty.mcap", 0)
    result = CliRunner().invoke(main, ["replay", empty, FLEET, "--loop", *options])
    assert result.exit_code == 0, result.stderr


@pytest.mark.slow
@pytest.mark.live
@pytest.mark.ports
def test_the_space_bar_pauses_and_goes_on(tmp_path):
    bag(tmp_path / "run.mcap", 3600)
    line = ["replay", "run.mcap", FLEET, "--port", str(free_port()), "--wait", "0"]
    with at_terminal(*warm.command(), *line, cwd=tmp_path) as terminal:
        terminal.wait_for("the space bar pauses")
        terminal.wait_for("replaying run.mcap ... 0%, ")
        terminal.type(" ")
        terminal.wait_for("paused, ")
        before = len(terminal.shown)
        terminal.type(" ")
        terminal.wait_for(" s of it, ", after=before)


@pytest.mark.live
@pytest.mark.ports
def test_a_recorder_shows_how_much_there_is(tmp_path):
    line = ["record", "-o", "run.mcap", "--port", str(free_port()), "--duration", "2"]
    with at_terminal(*warm.command(), *line, cwd=tmp_path) as terminal:
        terminal.wait_for("recording ... 0 JAUS messages, 0 of ROS, 0.0 MB of run.mcap, ")
        terminal.wait_for("0 JAUS messages on port")
        terminal.wait_for("written: run.mcap")
