"""`jausml record` beside those who speak: what passes on loopback stands in both files."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time

import needs
import pytest
import warm
from isolation import small_folder
from network_hosts import NetworkHost
from ports import free_port
from recordings import PATIENCE, by_mcap, datagram, event, pose, velocity, wait_for

from jausml.cli.live import record
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.traffic.captures import read_frames
from jausml.live.traffic.frames import UdpReader

pytestmark = [pytest.mark.live, pytest.mark.ports]


def test_topics_that_nobody_publishes_are_told_beside_the_recording(capsys):
    record._show_awaited([f"/vehicle/topic_{number}" for number in range(record._NAMED + 2)])
    said = capsys.readouterr()
    assert said.out == ""
    assert "nobody publishes /vehicle/topic_0 yet\n" in said.err
    assert said.err.endswith("nor 2 other topics of the model\n")


def test_patterns_may_be_repeated():
    options = ("--topic", "/a", "--topic", "/b*", "--exclude", "/b1", "--exclude", "/b2")
    parameters = record.command.make_context("record", [*options]).params
    assert (parameters["topics"], parameters["excluded"]) == (("/a", "/b*"), ("/b1", "/b2"))


def says(number, port):
    """Sends so many messages to a receiver on loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker:
        for index in range(number):
            speaker.sendto(datagram(velocity(2.0, 0.5, 0.25), number=index), ("127.0.0.1", port))


class Recording:
    """The verb, which runs until it is told to end."""

    def __init__(self, folder, port, *options, prefix=()):
        self.path, self.log = folder / "run.mcap", folder / "run.log"
        self.capture = self.path.with_suffix(".pcap")
        line = ["record", "--output", str(self.path), "--port", str(port), *options]
        with self.log.open("wb") as log:
            program = [*prefix, sys.executable, "-m", "jausml"] if prefix else warm.command()
            self.process = subprocess.Popen([*program, *line], stderr=log)

    def begin(self):
        wait_for(lambda: "record" in self.log.read_text(), "begin")

    def begin_with_frames(self):
        """Waits for the beginning of a recording that sees frames of others."""
        needs.ask("capture")
        self.begin()

    def frames(self):
        with self.capture.open("rb") as stream:
            return list(read_frames(stream))

    def end(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        return self.process.wait(timeout=PATIENCE)

    def close(self):
        self.process.kill()
        self.process.wait()


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """Messages to one receiver, one to the group, and others that are no JAUS."""
    port = free_port()
    made = Recording(tmp_path_factory.mktemp("recording"), port)
    try:
        made.begin_with_frames()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker:
            speaker.sendto(b"no JAUS" * 10, ("127.0.0.1", port + 1))
            for number in range(3):
                speaker.sendto(
                    datagram(velocity(2.0, 0.5, 0.25), number=number), ("127.0.0.1", port)
                )
            loopback = socket.inet_aton("127.0.0.1")
            speaker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)
            speaker.sendto(datagram(event(pose(1.0, 2.0, 0.0))), ("239.255.0.1", port))
        # Each frame once, though loopback shows it twice.
        wait_for(lambda: made.capture.stat().st_size > 24 + 4 * (16 + 28), "frames")
        made.port, made.code = port, made.end()
        yield made
    finally:
        made.close()


def test_messages_stand_in_the_file_as_json(recording):
    assert recording.code == 0
    found = [
        (channel.topic, json.loads(message.data)["fields"])
        for _, channel, message in by_mcap(recording.path)
    ]
    topics = [topic for topic, _ in found]
    assert topics == [*["/jaus/100.1.1/ReportVelocityState"] * 3, "/jaus/100.1.1/ReportLocalPose"]
    assert found[0][1]["Velocity_X"] == pytest.approx(2.0, abs=1e-6)
    assert found[3][1]["Y"] == pytest.approx(2.0, abs=1e-3)
    assert "4 JAUS messages" in recording.log.read_text()


def test_capture_beside_it_has_the_same_at_the_same_times(recording):
    reader = UdpReader(recording.port)
    datagrams = [reader.read(frame) for frame in recording.frames()]
    assert [packet.data[0] for packet in datagrams] == [2] * 4
    times = [message.log_time for _, _, message in by_mcap(recording.path)]
    assert [packet.nanoseconds for packet in datagrams] == times
    assert abs(times[0] - time.time_ns()) < 3600 * 10**9
    assert not any(reader.skipped.values())


def test_nothing_is_overwritten_and_nothing_is_left_behind(tmp_path):
    (tmp_path / "run.pcap").write_bytes(b"precious")
    line = [*warm.command(), "record", "--output", str(tmp_path / "run.mcap")]
    done = subprocess.run(line, capture_output=True, text=True, timeout=PATIENCE)
    assert "run.pcap is there already; --force overwrites it" in done.stderr
    assert done.returncode == 2
    assert [path.name for path in tmp_path.iterdir()] == ["run.pcap"]


@pytest.mark.needs("namespaces of networks")
def test_it_goes_on_after_an_outage_of_the_interface(tmp_path):
    host = NetworkHost("127.0.0.1")
    made = Recording(tmp_path, 3794, prefix=host.command(()))
    said = "".join(f"\\x{octet:02x}" for octet in datagram(velocity(2.0, 0.5, 0.25)))

    def is_recorded():
        host.run("bash", "-c", f"printf '{said}' > /dev/udp/127.0.0.1/3794")
        return made.capture.stat().st_size > 24

    try:
        made.begin_with_frames()
        for state in ("down", "up"):
            host.run("ip", "link", "set", "lo", state)
        wait_for(is_recorded, "message after the outage")
        assert made.end() == 0
    finally:
        made.close()
        host.close()
    assert "outages of the interface: 1\n" in made.log.read_text()


@pytest.mark.slow
@pytest.mark.needs("setpriv")
@pytest.mark.skipif(os.geteuid() != 0, reason="root alone gives a capability away")
def test_without_the_capability_the_group_is_heard(tmp_path):
    port = free_port()
    made = Recording(tmp_path, port, prefix=("setpriv", "--bounding-set=-net_raw"))
    try:
        made.begin()
        said = made.log.read_text()
        assert "needs CAP_NET_RAW" in said
        assert "the multicast group alone is recorded" in said
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker:
            loopback = socket.inet_aton("127.0.0.1")
            speaker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)

            def is_heard():
                # Who says it first may be too early for the listener.
                speaker.sendto(datagram(event(pose(1.0, 2.0, 0.0))), ("239.255.0.1", port))
                return made.capture.stat().st_size > 24

            wait_for(is_heard, "message to the group")
        assert made.end() == 0
    finally:
        made.close()
    topics = {channel.topic for _, channel, _ in by_mcap(made.path)}
    assert topics == {"/jaus/100.1.1/ReportLocalPose"}
    assert UdpReader(port).read(made.frames()[0]) is not None


def test_a_kill_takes_nothing_that_was_flushed(tmp_path):
    port = free_port()
    made = Recording(tmp_path, port, "--flush-every", "0.1")
    try:
        made.begin_with_frames()
        size = made.path.stat().st_size
        says(3, port)
        wait_for(lambda: made.path.stat().st_size > size, "messages in the file")
        made.process.kill()
        assert made.process.wait(timeout=PATIENCE) == -signal.SIGKILL
    finally:
        made.close()
    cut = McapRecording(str(made.path))
    found = [channel.topic for _, channel, _ in cut.messages()]
    assert found
    assert set(found) == {"/jaus/100.1.1/ReportVelocityState"}
    # It is killed after all was flushed, or before the end stands behind it again.
    assert re.search("its recorder was stopped|in the midst of a record", cut.fault)
    assert len(made.frames()) >= len(found)


@pytest.fixture
def small_disk(tmp_path):
    """A folder that is soon full."""
    needs.ask("mounts")
    with small_folder(tmp_path / "disk", 1 << 16):
        yield tmp_path / "disk"


@pytest.mark.slow
def test_a_full_disk_is_told_and_leaves_what_it_took(small_disk):
    port = free_port()
    made = Recording(small_disk, port, "--flush-every", "0.05", "--compression", "none")
    try:
        made.begin_with_frames()

        def is_over():
            says(20, port)
            return made.process.poll() is not None

        wait_for(is_over, "end")
        said = made.log.read_text()
        assert made.process.returncode == 2, said
        assert "run.mcap: No space left on device; all until 20" in said
        assert "were lost since" in said
        assert "Traceback" not in said
        found = [message.log_time for _, _, message in McapRecording(str(made.path)).messages()]
        assert found == [frame.nanoseconds for frame in made.frames()]
        assert len(found) > 20
        assert [message.log_time for _, _, message in by_mcap(made.path)] == found
    finally:
        made.close()


@pytest.mark.slow
def test_a_row_of_files_of_the_components_that_are_named(tmp_path):
    port = free_port()
    options = ("--flush-every", "0.05", "--max-duration", "0.2", "--max-files", "3")
    made = Recording(tmp_path, port, *options, "--component", "101.*")

    def row():
        return sorted(int(path.stem.removeprefix("run_")) for path in tmp_path.glob("run_*.mcap"))

    def has_gone_on():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker:
            for source in ((100, 1, 1), (101, 1, 2)):
                speaker.sendto(
                    datagram(velocity(1.0, 0.0, 0.0), source=source), ("127.0.0.1", port)
                )
        return max(row(), default=0) >= 5

    try:
        made.begin_with_frames()
        wait_for(has_gone_on, "files")
        assert made.end(signal.SIGHUP) == 0  # its terminal has gone
    finally:
        made.close()
    numbers = row()
    assert numbers == list(range(numbers[0], numbers[0] + 3))
    files = [tmp_path / f"run_{number}.mcap" for number in numbers]
    assert {file.with_suffix(".pcap") for file in files} == set(tmp_path.glob("*.pcap"))
    assert all(file.name in made.log.read_text() for file in files)
    found = [entry for file in files for entry in by_mcap(file)]
    times = [message.log_time for _, _, message in found]
    assert times
    assert times == sorted(times)
    assert {channel.topic for _, channel, _ in found} == {"/jaus/101.1.2/ReportVelocityState"}
