"""`jausml record`: both sides of a running system into one file, and a capture beside it."""

from __future__ import annotations

import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.captures import skipped_lines
from jausml.cli.common import EnvironmentFault, FiniteRange
from jausml.cli.messages import open_catalogue
from jausml.cli.network import ended_by_signals
from jausml.cli.options import interface_option, multicast_group_option, port_option
from jausml.cli.recordings import force_option, output_option, valid_model, written

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.live.traffic.captures import Frame
    from jausml.live.traffic.frames import UdpReader
    from jausml.live.traffic.interface import InterfaceCapture
    from jausml.recording.recorder import Recorder
    from jausml.recording.ros_topics import RosTopics
    from jausml.runtime.base.settings import TransportSettings

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
    from jausml.recording.errors import RecordingError
    from jausml.recording.mcap_writing import McapFile
    from jausml.recording.recorder import Recorder, topics_of
    from jausml.recording.ros_topics import RosTopics
    from jausml.runtime.base.settings import TransportSettings

    if output is None:
        raise click.UsageError("say with --output which file is written")
    try:
        settings = TransportSettings(
            interface=interface, port=port, multicast_group=multicast_group
        )
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    definitions = topics_of(valid_model(model)) if model is not None else {}
    catalogue = open_catalogue([model] if model is not None else [])
    with ExitStack() as stack:
        stack.enter_context(ended_by_signals())
        capture = stack.enter_context(written(str(Path(output).with_suffix(".pcap")), force=force))
        stream = stack.enter_context(written(output, force=force))
        try:
            file = stack.enter_context(McapFile(stream, has_jaus=True))
            recorder = Recorder(file, catalogue, definitions)
            ros = RosTopics(None if all_topics else definitions, recorder.take_topic)
            if definitions or all_topics:
                _start(ros, is_wanted=all_topics)
                stack.callback(ros.stop)
        except RecordingError as error:
            raise EnvironmentFault(str(error)) from error
        from jausml.live.traffic.frames import UdpReader
        from jausml.live.traffic.writing import PcapWriter

        reader, writer = UdpReader(port), PcapWriter(capture)
        try:
            for frame in _frames(settings, duration):
                if frame is None:
                    capture.flush()  # whoever looks into it now finds all
                    continue
                datagram = reader.read(frame)
                if datagram is not None:
                    recorder.take_datagram(datagram)
                if datagram is not None or _is_fragment(frame.data):
                    writer.write(frame)
        except KeyboardInterrupt:
            click.echo("interrupted", err=True)
        ros.stop()
        _tell(recorder, ros, reader, port)


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


def _frames(settings: TransportSettings, duration: float | None) -> Iterator[Frame | None]:
    """Yields what passes the interface, or the group where that cannot be seen; None in between."""
    from jausml.live.traffic.errors import TrafficError
    from jausml.live.traffic.interface import InterfaceCapture

    end = float("inf") if duration is None else time.monotonic() + duration
    try:
        capture = InterfaceCapture(settings.interface)
    except TrafficError as error:
        click.echo(f"{error}; of JAUS the multicast group alone is recorded", err=True)
        yield from _heard(settings, end)
        return
    with capture:
        click.echo(f"recording what passes {settings.interface}", err=True)
        yield from _captured(capture, end)


def _captured(capture: InterfaceCapture, end: float) -> Iterator[Frame | None]:
    for frame in capture.frames():
        yield frame
        if time.monotonic() >= end:
            break
    lost = capture.lost()
    if lost:
        click.echo(f"{lost} frames were lost: the host was too busy", err=True)


def _heard(settings: TransportSettings, end: float) -> Iterator[Frame]:
    from jausml.live.traffic.errors import TrafficError
    from jausml.live.traffic.listening import MulticastListener
    from jausml.live.traffic.writing import frame_of

    try:
        listener = MulticastListener(settings)
    except TrafficError as error:
        raise EnvironmentFault(str(error)) from error
    with listener:
        duration = None if end == float("inf") else max(0.0, end - time.monotonic())
        yield from map(frame_of, listener.datagrams(duration))


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
