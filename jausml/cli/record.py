"""`jausml record`: both sides of a running system into one file, and a capture beside it."""

from __future__ import annotations

import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import click

from jausml.cli.captures import skipped_lines
from jausml.cli.common import EnvironmentFault, FiniteRange
from jausml.cli.messages import open_catalogue
from jausml.cli.options import interface_option, multicast_group_option, port_option
from jausml.cli.recordings import (
    already_there,
    force_option,
    output_option,
    stopped_by_signals,
    valid_model,
    written,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from threading import Event

    from jausml.live.traffic.captures import Frame
    from jausml.live.traffic.frames import UdpReader
    from jausml.recording.recorder import Recorder
    from jausml.recording.ros_topics import RosTopics
    from jausml.runtime.base.settings import TransportSettings

_TURN = 0.1
_FRAGMENT = 0x3FFF


@click.command("record")
@click.argument("model", metavar="[MODEL]", required=False)
@output_option
@force_option
@click.option("--all-topics", is_flag=True, help="Record all topics of ROS, not those of MODEL.")
@interface_option()
@port_option()
@multicast_group_option()
@click.option("--duration", type=FiniteRange(0), metavar="S", help="End after so many seconds.")
def command(
    model: str | None,
    output: str | None,
    force: bool,
    all_topics: bool,
    interface: str,
    port: int,
    multicast_group: str,
    duration: float | None,
) -> None:
    """Record both sides of a running system until Ctrl-C.

    FILE gets the JAUS messages that pass the interface, as JSON, and the topics of the system in
    MODEL. Beside it stands what was captured, with the ending .pcap. Without MODEL there is JAUS
    alone, as there is where ROS is missing. Nothing is sent; to see what others are sent needs
    CAP_NET_RAW, as tcpdump does: without it the multicast group alone is heard.

    Exit status: 0 done, 1 problems in the model, 2 usage or environment, 3 internal error.
    """
    from threading import Event

    from jausml.live.traffic.frames import UdpReader
    from jausml.recording.errors import RecordingError
    from jausml.recording.mcap_writing import McapFile
    from jausml.recording.recorder import Recorder, topics_of
    from jausml.recording.ros_topics import RosTopics
    from jausml.runtime.base.settings import TransportSettings

    capture_path = _beside(output, force=force)
    try:
        settings = TransportSettings(
            interface=interface, port=port, multicast_group=multicast_group
        )
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    definitions = topics_of(valid_model(model)) if model is not None else {}
    catalogue = open_catalogue([model] if model is not None else [])
    stop = Event()
    with ExitStack() as stack:
        stack.enter_context(stopped_by_signals(stop))
        capture = stack.enter_context(written(capture_path, force=force))
        stream = stack.enter_context(written(str(output), force=force))
        try:
            file = stack.enter_context(McapFile(stream, has_jaus=True))
            recorder = Recorder(file, catalogue, definitions)
            ros = RosTopics(None if all_topics else definitions, recorder.take_topic)
            if definitions or all_topics:
                _start(ros, is_wanted=all_topics)
                stack.callback(ros.stop)
        except RecordingError as error:
            raise EnvironmentFault(str(error)) from error
        reader = UdpReader(port)
        _record(_until(_frames(settings), duration, stop), reader, recorder, capture)
        ros.stop()
        _tell(recorder, ros, reader, port)


def _beside(output: str | None, *, force: bool) -> str:
    """Returns where the capture stands, once it is sure that nothing would be overwritten."""
    if output is None:
        raise click.UsageError("say with --output which file is written")
    found = str(Path(output).with_suffix(".pcap"))
    if found == output:
        raise click.UsageError("the capture stands beside FILE, which needs another ending: .mcap")
    for path in (output, found):
        if not force and Path(path).exists():
            raise already_there(path)
    return found


def _record(
    frames: Iterable[Frame | None], reader: UdpReader, recorder: Recorder, capture: BinaryIO
) -> None:
    """Writes what passes; where nothing does, whoever looks into the capture finds all."""
    from jausml.live.traffic.writing import PcapWriter

    writer = PcapWriter(capture)
    for frame in frames:
        if frame is None:
            capture.flush()
            continue
        datagram = reader.read(frame)
        if datagram is not None:
            recorder.take_datagram(datagram)
        if datagram is not None or _is_fragment(frame.data):
            writer.write(frame)


def _until(
    frames: Iterator[Frame | None], duration: float | None, stop: Event
) -> Iterator[Frame | None]:
    end = float("inf") if duration is None else time.monotonic() + duration
    for frame in frames:
        yield frame
        if stop.is_set() or time.monotonic() >= end:
            break
    frames.close()  # type: ignore[attr-defined]  # a generator, which says what was lost


def _start(ros: RosTopics, *, is_wanted: bool) -> None:
    from jausml.recording.errors import RecordingError

    try:
        ros.start()
    except RecordingError as error:
        if is_wanted:
            raise
        click.echo(f"JAUS alone is recorded: {error}", err=True)


def _is_fragment(packet: bytes) -> bool:
    """Whether a frame of raw IP is one of several of a packet, as far as is easily seen."""
    is_first_version = packet[0] >> 4 == 4
    return not is_first_version or bool(int.from_bytes(packet[6:8], "big") & _FRAGMENT)


def _frames(settings: TransportSettings) -> Iterator[Frame | None]:
    """Yields what passes the interface, or the group where that cannot be seen; None in between."""
    from jausml.live.traffic.errors import TrafficError
    from jausml.live.traffic.interface import InterfaceCapture

    try:
        capture = InterfaceCapture(settings.interface)
    except TrafficError as error:
        click.echo(f"{error}; of JAUS the multicast group alone is recorded", err=True)
        yield from _heard(settings)
        return
    with capture:
        click.echo(f"recording what passes {settings.interface}", err=True)
        try:
            yield from capture.frames()
        finally:
            lost = capture.lost()
            if lost:
                click.echo(f"{lost} frames were lost: the host was too busy", err=True)


def _heard(settings: TransportSettings) -> Iterator[Frame | None]:
    from jausml.live.traffic.errors import TrafficError
    from jausml.live.traffic.listening import MulticastListener
    from jausml.live.traffic.writing import frame_of

    try:
        listener = MulticastListener(settings)
    except TrafficError as error:
        raise EnvironmentFault(str(error)) from error
    with listener:
        while True:
            yield from map(frame_of, listener.datagrams(_TURN))
            yield None


def _tell(recorder: Recorder, ros: RosTopics, reader: UdpReader, port: int) -> None:
    click.echo(f"{recorder.captured.count} JAUS messages", err=True)
    for topic, number in sorted(recorder.topics.items()):
        click.echo(f"  {number} on {topic}", err=True)
    for topic in sorted(set(ros.wanted or ()) - set(recorder.topics) - set(ros.missing)):
        click.echo(f"  none on {topic}", err=True)
    for topic, kind in sorted(ros.missing.items()):
        click.echo(f"  {topic} is not recorded: {kind} is not installed", err=True)
    for topic in sorted(recorder.undefined):
        click.echo(f"  {topic} is not recorded: nobody defines its type here", err=True)
    for reason, number in sorted(recorder.jaus.undecoded.items()):
        click.echo(f"  {number} JAUS messages are in the capture alone: {reason}", err=True)
    for line in skipped_lines(reader, port):
        click.echo(line, err=True)
    for reason, number in sorted(recorder.captured.skipped.items()):
        click.echo(f"skipped {number}: {reason}", err=True)
