"""`jausml record`: both sides of a running system into one file, and a capture beside it."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from math import inf
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING

import click

from jausml.cli.live.recordings import (
    already_there,
    force_option,
    output_option,
    shown_time,
    skipped_lines,
    transport_settings,
)
from jausml.cli.shared.files import EnvironmentFault, cannot_write, ending_at
from jausml.cli.shared.models import open_catalogue, optional_model_argument
from jausml.cli.shared.options import FiniteRange, place_options
from jausml.cli.shared.terminal import remark, step

if TYPE_CHECKING:
    from jausml.live.recording.recorder import Recorder, RecordingFiles, SplitLimits
    from jausml.live.recording.ros_topics import RosTopics
    from jausml.live.traffic.captures import CapturedFrame
    from jausml.live.traffic.frames import UdpReader
    from jausml.live.traffic.listening import InterfaceCapture, MulticastListener
    from jausml.runtime.base.settings import TransportSettings

_TURN = 0.1
_MEGA = 10**6
_FRAGMENT = 0x3FFF

_NAMED = 5  # topics without a publisher that are named, the others are counted


@click.command("record")
@optional_model_argument
@output_option
@force_option
@click.option("--all-topics", is_flag=True, help="Record all ROS topics, not only those of MODEL.")
@click.option(
    "--topic",
    "topics",
    multiple=True,
    metavar="PATTERN",
    help="Record only these ROS topics, from MODEL or, without it, from all; * matches anything; "
    "may be repeated.",
)
@click.option(
    "--exclude",
    "excluded",
    multiple=True,
    metavar="PATTERN",
    help="Omit these ROS topics; may be repeated.",
)
@click.option(
    "--component",
    "components",
    multiple=True,
    metavar="ID",
    help="Record only what this JAUS component sends and receives, such as 100.1.10 or 100.*; "
    "may be repeated.",
)
@place_options
@click.option("--duration", type=FiniteRange(0), metavar="S", help="End after this many seconds.")
@click.option(
    "--flush-every",
    type=FiniteRange(0.05, 3600),
    default=1.0,
    metavar="S",
    help="Flush the files to the disk every S seconds; if the power fails, this is what you lose.",
)
@click.option(
    "--max-size",
    type=FiniteRange(0, min_open=True),
    metavar="MB",
    help="Continue in a new numbered FILE when both files have reached this many megabytes.",
)
@click.option(
    "--max-duration",
    type=FiniteRange(0, min_open=True),
    metavar="S",
    help="Continue in a new numbered FILE after this many seconds.",
)
@click.option(
    "--max-files",
    type=click.IntRange(1),
    metavar="N",
    help="Keep only the newest N numbered files, including those of earlier recordings: FILE_0 to "
    "FILE_9999.",
)
@click.option(
    "--compression",
    type=click.Choice(["zstd", "lz4", "none"]),
    default="zstd",
    help="Compression of the MCAP file.",
)
def command(
    model: str | None,
    output: str | None,
    force: bool,
    all_topics: bool,
    topics: tuple[str, ...],
    excluded: tuple[str, ...],
    components: tuple[str, ...],
    interface: str,
    port: int,
    multicast_group: str,
    duration: float | None,
    flush_every: float,
    max_size: float | None,
    max_duration: float | None,
    max_files: int | None,
    compression: str,
) -> None:
    """Record both sides of a running system until Ctrl-C.

    FILE contains the JAUS messages on the interface, as JSON, and the ROS topics of the system in
    MODEL, by default that of the project of the current folder. The capture is written beside it,
    with the ending .pcap. Without a model, or without ROS, only JAUS is recorded. From the moment
    at which it says "recording", all that is sent and published by those who are there is recorded;
    topics that nobody publishes by then are named, and join when somebody does. The recorder sends
    nothing. To see messages between others it needs CAP_NET_RAW, like tcpdump; without it, it
    receives only the multicast group.

    After a power failure or a kill, everything that was flushed is still readable: `jausml replay`
    reads and repairs files that were cut off.

    Exit status: 0 done, 1 the model cannot be read, 2 usage or environment, a full disk among them,
    3 internal error.
    """
    from threading import Event

    from jausml.live.recording.mcap_files import TrafficFilter
    from jausml.live.recording.recorder import Recorder, SplitLimits, topics_of
    from jausml.live.recording.ros_topics import RosTopics
    from jausml.live.signals import ended_by_signals
    from jausml.live.traffic.frames import UdpReader

    size = None if max_size is None else int(min(max_size, _MEGA**2) * _MEGA)
    limits = SplitLimits(size, max_duration, max_files)
    path = _output(output, limits, force=force)
    for pattern in (*topics, *excluded):
        if not pattern.startswith(("/", "*", "?", "[")):
            raise click.UsageError(f"no topic is {pattern!r}: full names begin with /, /{pattern}")
    settings = transport_settings(interface, port, multicast_group)
    selection = TrafficFilter(topics, excluded, components)
    is_any = all_topics or (model is None and bool(topics))
    stop = Event()
    with ExitStack() as stack:
        stack.enter_context(ended_by_signals(stop.set))
        ros = RosTopics(selection)
        # ROS looks around while the model is read.
        speaks_ros = (model is not None or is_any) and _entered(ros, stack, is_wanted=is_any)
        catalogue = open_catalogue([] if model is None else [model])
        types = {} if model is None else topics_of(catalogue.model)
        frames, what = _opened(settings, stack)
        parts = _parts(path, limits, compression, force=force)
        recorder = Recorder(parts, catalogue, types, selection, ros.offers)
        stack.enter_context(recorder.kept(flush_every, ros.repeat_latched))
        if speaks_ros and (types or is_any):
            ros.begin(None if is_any else types, recorder.take_topic)
            stack.callback(ros.stop)
        _show_awaited([*filter(_is_usual, ros.unpublished())])
        click.echo(what, err=True)
        reader = UdpReader(port)
        with step("recording") as progress:
            progress.note = partial(_so_far, recorder, parts)
            for frame in _until(frames, duration, stop, recorder):
                _take(frame, reader, recorder)
    _show_counts(recorder, ros, reader, settings)
    _show_files(parts, recorder)


def _output(output: str | None, limits: SplitLimits, *, force: bool) -> Path:
    """Returns the path of the MCAP file, unless a file would be overwritten."""
    if output is None:
        raise click.UsageError("say with --output which file is written")
    if limits.files is not None and not limits.splits:
        raise click.UsageError("--max-files needs --max-size or --max-duration")
    path = Path(output)
    if path.is_dir():
        raise click.UsageError(f"{output} is a folder; --output is a file in one")
    capture = path.with_suffix(".pcap")
    if capture == path:
        raise click.UsageError("the capture stands beside FILE, which needs another ending: .mcap")
    for file in (path, capture):
        if not (force or limits.splits) and file.exists():
            raise already_there(str(file))
    return path


def _parts(path: Path, limits: SplitLimits, compression: str, *, force: bool) -> RecordingFiles:
    """Returns the files, which are made."""
    from jausml.live.recording.mcap_files import RecordingError
    from jausml.live.recording.recorder import RecordingFiles

    try:
        return RecordingFiles(path, limits, compression, overwrites=force)
    except RecordingError as error:
        raise EnvironmentFault(str(error)) from error
    except OSError as error:
        raise cannot_write(path, error) from error


def _so_far(recorder: Recorder, parts: RecordingFiles) -> str:
    """Returns the line that a terminal shows during a recording."""
    of_ros = sum(list(recorder.topics.values()))  # at once: others add topics
    size = f"{parts.current.size / _MEGA:.1f} MB of {parts.current.path.name}"
    return f"{recorder.captured.count} JAUS messages, {of_ros} of ROS, {size}"


def _take(frame: CapturedFrame | None, reader: UdpReader, recorder: Recorder) -> None:
    datagram = None if frame is None else reader.read(frame)
    if frame is not None and (datagram is not None or _is_fragment(frame.data)):
        recorder.take_frame(frame, datagram)


def _until(
    frames: Iterator[CapturedFrame | None], duration: float | None, stop: Event, recorder: Recorder
) -> Iterator[CapturedFrame | None]:
    """Yields frames until the end, including late ones of earlier times."""
    end = inf if duration is None else time.monotonic() + duration
    ended = inf  # by the clock of the frames
    for frame in frames:
        is_over = ended < inf and (frame is None or (frame.time or inf) >= ended)
        if is_over or recorder.fault is not None:
            break
        yield frame
        if ended == inf and (stop.is_set() or time.monotonic() >= end):
            ended = time.time()


def _entered(ros: RosTopics, stack: ExitStack, *, is_wanted: bool) -> bool:
    """Enters ROS; returns whether there is one here."""
    from jausml.live.recording.mcap_files import RecordingError
    from jausml.runtime.bridge.ros.environment import environment_fault

    fault = environment_fault()
    if fault:
        raise EnvironmentFault(fault)
    try:
        ros.open()
    except RecordingError as error:
        if is_wanted:
            raise EnvironmentFault(str(error)) from error
        click.echo(f"JAUS alone is recorded: {error}", err=True)
        return False
    stack.callback(ros.stop)
    return True


def _is_fragment(packet: bytes) -> bool:
    """Whether a frame of raw IP is one of several of a packet, as far as is easily seen."""
    is_first_version = packet[0] >> 4 == 4
    return not is_first_version or bool(int.from_bytes(packet[6:8], "big") & _FRAGMENT)


def _opened(
    settings: TransportSettings, stack: ExitStack
) -> tuple[Iterator[CapturedFrame | None], str]:
    """Returns the frames of the interface, None between them, and a remark on what they lack.

    Where that cannot be seen, it is what the group is sent.
    """
    from jausml.live.traffic.captures import TrafficError
    from jausml.live.traffic.listening import InterfaceCapture, MulticastListener

    try:
        capture = stack.enter_context(InterfaceCapture(settings.interface))
    except TrafficError as error:
        what = f"{error}; of JAUS the multicast group alone is recorded"
    else:
        stack.callback(_show_lost, capture)
        return capture.frames(), f"recording what passes {settings.interface}"
    with ending_at(TrafficError):
        return _heard(stack.enter_context(MulticastListener(settings))), what


def _show_lost(capture: InterfaceCapture) -> None:
    lost = capture.lost()
    if lost:
        click.echo(f"{lost} frames were lost: the host was too busy", err=True)
    if capture.outages:
        click.echo(f"outages of the interface: {capture.outages}", err=True)


def _heard(listener: MulticastListener) -> Iterator[CapturedFrame | None]:
    from jausml.live.traffic.frames import frame_of

    while True:
        yield from map(frame_of, listener.datagrams(_TURN))
        yield None


def _is_usual(topic: str) -> bool:
    """Tells whether a topic may be missed: before Kilted, goals and results are not published."""
    from jausml.live.recording.recorder import ACTION_TOPICS, CALLS

    return not (topic.endswith(ACTION_TOPICS) and topic.endswith(CALLS))


def _show_awaited(topics: Sequence[str]) -> None:
    for topic in topics[:_NAMED]:
        click.echo(f"nobody publishes {topic} yet", err=True)
    if topics[_NAMED:]:
        click.echo(f"nor {len(topics) - _NAMED} other topics of the model", err=True)


def _show_counts(
    recorder: Recorder, ros: RosTopics, reader: UdpReader, settings: TransportSettings
) -> None:
    from jausml.live.recording.recorder import CALLS

    place = f" on port {settings.port} of {settings.interface}; --port and --interface choose"
    hint = "" if recorder.captured.count else f"{place} others"
    click.echo(f"{recorder.captured.count} JAUS messages{hint}", err=True)
    for topic, number in sorted(recorder.topics.items()):
        lost = f", {ros.lost[topic]} were lost before" if ros.lost[topic] else ""
        early = f"; {ros.early[topic]} came before it was heard" if ros.early[topic] else ""
        click.echo(f"  {number} on {topic}{lost}{early}", err=True)
    for topic in filter(
        _is_usual, sorted(set(ros.wanted or ()) - {*recorder.topics, *ros.missing, *ros.mixed})
    ):
        is_unheard = topic.endswith(CALLS) and topic not in ros.heard
        why = ": its node does not publish its calls" if is_unheard else ""
        click.echo(f"  none on {topic}{why}", err=True)
    for topic, kind in sorted(ros.missing.items()):
        click.echo(f"  {topic} is not recorded: {kind} is not installed", err=True)
    for topic, kinds in sorted(ros.mixed.items()):
        how = "one of them is" if topic in ros.heard else "it is not"
        click.echo(f"  {topic} is published as {' and '.join(kinds)}; {how} recorded", err=True)
    for topic in sorted(recorder.undefined):
        click.echo(f"  {topic} is not recorded: nobody defines its type here", err=True)
    for reason, number in sorted(recorder.jaus.undecoded.items()):
        click.echo(f"  {number} JAUS messages are in the capture alone: {reason}", err=True)
    for line in skipped_lines(reader, settings.port):
        click.echo(line, err=True)
    for reason, number in sorted(recorder.captured.skipped.items()):
        click.echo(f"skipped {number}: {reason}", err=True)


def _show_files(parts: RecordingFiles, recorder: Recorder) -> None:
    """Shows the written files, or why no more could be written."""
    if recorder.fault is None:
        names = ", ".join(click.format_filename(path) for path in parts.paths)
        remark(f"written: {names}, captures beside")
        return
    until = "nothing" if recorder.reached is None else f"all until {shown_time(recorder.reached)}"
    fault = cannot_write(parts.current.path, recorder.fault)
    raise EnvironmentFault(f"{fault}; {until} is in the files; {recorder.lost} were lost since")
