"""`jausml replay`: captures through the maps of a model into a file, topics to the wire."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Iterator
from functools import partial
from itertools import chain, islice
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any, BinaryIO

import click

from jausml import installing
from jausml.cli.live.recordings import (
    force_option,
    not_itself,
    opened,
    output_option,
    shown_time,
    skipped_lines,
    written,
)
from jausml.cli.shared.files import PROBLEMS, STDIN, EnvironmentFault, shown_path
from jausml.cli.shared.models import bridge_options, only_system, open_catalogue, valid_model
from jausml.cli.shared.options import (
    FiniteRange,
    interface_option,
    multicast_group_option,
    port_option,
    refuse_options,
)
from jausml.cli.shared.terminal import Progress, pressed, step, warn

if TYPE_CHECKING:
    from jausml.language.model import Model
    from jausml.live.recording.bags import Bag, RosMessage
    from jausml.live.recording.captured import JausWriter
    from jausml.live.recording.mcap_files import TimeSpan
    from jausml.live.recording.to_wire import ReplayPace, WireReplay
    from jausml.live.recording.translating import CaptureReplay, Translator
    from jausml.live.traffic.captures import CapturedFrame

_NANO = 10**9
_TO_JAUS = (
    *("interface", "multicast_group", "loop", "speed", "max_rate"),
    *("count", "wait", "hold", "allow_commands"),
)
"""Options that only what goes to JAUS has."""
_UNREAD = "not_decodable"
"""How bridges count messages that are none of their type."""


@click.command("replay")
@click.argument("recording", metavar="RECORDING")
@click.argument("model", metavar="[MODEL]", required=False)
@output_option
@force_option
@click.option(
    "--with-jaus",
    is_flag=True,
    help="Include the JAUS messages in FILE, as JSON; ros2 bag cannot play such a file.",
)
@click.option(
    "--ros-only",
    is_flag=True,
    help="Without MODEL: write only the ROS topics to FILE, so that ros2 bag can play it.",
)
@interface_option()
@port_option()
@multicast_group_option()
@click.option(
    "--start",
    type=FiniteRange(0),
    default=0.0,
    show_default=False,
    metavar="S",
    help="Begin this many seconds after the first message of RECORDING.",
)
@click.option("--duration", type=FiniteRange(0), metavar="S", help="End this many seconds later.")
@click.option("--loop", is_flag=True, help="Repeat a ROS recording until Ctrl-C.")
@click.option(
    "--speed",
    "--rate",
    type=FiniteRange(0, 100, min_open=True),
    default=1.0,
    help="Seconds of the recording to replay per second.",
)
@click.option(
    "--max-rate",
    type=FiniteRange(0, 10000, min_open=True),
    default=1000.0,
    metavar="HZ",
    help="Highest number of messages per second; messages beyond it are late.",
)
@click.option("--count", type=click.IntRange(1), help="End after this many messages to JAUS.")
@click.option(
    "--wait",
    type=FiniteRange(0, 3600),
    default=3.0,
    metavar="S",
    help="Seconds to wait before the first message, so that others find the bridges.",
)
@click.option(
    "--hold",
    type=FiniteRange(0, 3600),
    default=1.0,
    metavar="S",
    help="Seconds to keep the bridges after the last message.",
)
@click.option(
    "--allow-commands",
    is_flag=True,
    help="Send commands too; they move every vehicle that obeys, so check who receives them.",
)
@bridge_options
def command(
    recording: str,
    model: str | None,
    output: str | None,
    force: bool,
    with_jaus: bool,
    ros_only: bool,
    start: float,
    duration: float | None,
    bridge_address: str | None,
    **options: Any,
) -> None:
    """Replay recordings through the maps of MODEL.

    RECORDING is a capture (pcap or pcapng; - for stdin). Each message that a bridge of MODEL would
    take is translated as the bridge does it, and written to FILE with the time of its capture. If a
    map has both directions, what the bridge itself sent is translated too. Foxglove, PlotJuggler
    and `ros2 bag play` open FILE. If MODEL contains maps but no system, all maps are used, for the
    messages of every sender, each on a topic with the name of the map.

    Or RECORDING is a ROS recording: an MCAP file or a rosbag2 bag. Then the bridges of MODEL join
    the JAUS network, loopback by default, and receive its topics at their original times. They
    report to everybody who asks. Commands are omitted without --allow-commands: a recorded command
    moves a vehicle like the original one, whatever is around it now. On a terminal, the space bar
    pauses and continues.

    MODEL is by default that of the project of the current folder. But an MCAP file with --output is
    copied to FILE without MODEL. If it was cut off, FILE is complete again. Every replay reads a
    file that was cut off as far as possible.

    Exit status: 0 done, 1 problems in the model, in the recording or in what is in it (the rest is
    done), 2 usage or environment, 3 internal error.
    """
    from jausml.generation.errors import GenerationError, NoSystemError
    from jausml.language.model.project import Reading
    from jausml.live.recording.bags import MCAP, is_bag
    from jausml.live.recording.mcap_files import RecordingError, TimeSpan

    span = TimeSpan(start, duration)
    if output is not None:
        not_itself(recording, output)
    if model is None and output is not None and recording.endswith(MCAP):
        others = ("with_jaus", "port", "bridge_address", *_TO_JAUS)
        refuse_options("not where an MCAP file is copied", *others)
        _again(recording, output, span, force=force, ros_only=ros_only)
        return
    to_wire = is_bag(recording)
    if recording != STDIN and not Path(recording).exists():
        raise EnvironmentFault(f"{shown_path(recording)}: {os.strerror(errno.ENOENT)}")
    _check_ends(recording, model, output, is_bag=to_wire, with_jaus=with_jaus, ros_only=ros_only)
    if to_wire:
        refuse_options("only with --output", "force")
    else:
        refuse_options("only where a ROS recording goes to JAUS", *_TO_JAUS)
    model = model or only_system("MODEL")
    try:
        read = valid_model(model, Reading(bridge_address=bridge_address))
        if to_wire:
            is_done = _to_wire(recording, read, span, options)
        else:
            port = options["port"]
            paths = (recording, model, str(output))
            is_done = _to_file(read, paths, port, span, force=force, jaus=with_jaus)
    except NoSystemError as error:
        hint = "--bridge-address ID makes a bridge of its maps"
        raise EnvironmentFault(f"{error}; {hint}") from error
    except (RecordingError, GenerationError) as error:
        raise EnvironmentFault(str(error)) from error
    if not is_done:
        raise click.exceptions.Exit(PROBLEMS)


def _check_ends(
    recording: str,
    model: str | None,
    output: str | None,
    *,
    is_bag: bool,
    with_jaus: bool,
    ros_only: bool,
) -> None:
    """Checks that a recording can go where it shall."""
    if is_bag and model is None and output is not None:
        what = "name one that is in a bag, or make one by `ros2 bag convert`"
        raise click.UsageError(f"{shown_path(recording)} is no MCAP file: {what}")
    if is_bag and (output is not None or with_jaus):
        raise click.UsageError(f"{shown_path(recording)} goes to JAUS, not to a file")
    if ros_only:
        raise click.UsageError("--ros-only is for an MCAP file without MODEL")
    if not is_bag and output is None:
        raise click.UsageError("say with --output which file is written")


def _again(recording: str, output: str, span: TimeSpan, *, force: bool, ros_only: bool) -> None:
    """Writes an MCAP file again, as far as it can be read, or a part of it."""
    from jausml.live.recording.mcap_files import RecordingError, copied
    from jausml.live.recording.mcap_reading import McapRecording

    source = McapRecording(recording, span)
    try:
        messages = source.messages()
        first = list(islice(messages, 1))  # what cannot be read makes no file
        with written(output, force=force) as stream:
            count = copied(chain(first, messages), stream, ros_only=ros_only)
    except ImportError as error:
        raise EnvironmentFault(
            f"{error.name} is missing: {installing.command('record')}"
        ) from error
    except RecordingError as error:
        raise EnvironmentFault(str(error)) from error
    click.echo(f"{count} messages", err=True)
    if _warn_if_damaged(recording, source.fault, source.reached):
        raise click.exceptions.Exit(PROBLEMS)


def _warn_if_damaged(path: str, fault: str, reached: int | None) -> bool:
    """Warns of the part of a recording that cannot be read; returns whether there is one."""
    if fault and reached is not None:
        until = shown_time(reached / _NANO)
        warn(f"{shown_path(path)} is not whole: {fault}; it was read until {until}")
    return bool(fault)


def _to_wire(recording: str, model: Model, span: TimeSpan, options: dict[str, Any]) -> bool:
    """Gives a recording of ROS to bridges; returns whether all that they take could be used."""
    from threading import Event

    from jausml.live.recording.bags import Bag
    from jausml.live.recording.to_wire import ReplayPace, WireReplay
    from jausml.live.signals import ended_by_signals

    stop = Event()
    bag, allowed = Bag(recording, span), options["allow_commands"]
    pace = ReplayPace(options["speed"], options["max_rate"], stop)
    transport = {name: options[name] for name in ("interface", "port", "multicast_group")}
    list(islice(bag.messages(), 1))  # what cannot be read opens no bridge
    with (
        ended_by_signals(stop.set),
        WireReplay(model, transport, allow_commands=allowed) as replay,
        pressed(partial(_pause, pace)) as has_keys,
    ):
        for command_name in replay.commands:
            what = "its commands are sent" if allowed else "left out without --allow-commands"
            click.echo(f"{command_name}: {what}", err=True)
        hint = "; the space bar pauses" if has_keys else ""
        wait = f"{options['wait']:g} s"
        click.echo(f"on the network; the first message comes in {wait}{hint}", err=True)
        stop.wait(options["wait"])
        with step(f"replaying {shown_path(recording)}") as progress:
            messages = _rounds(bag, pace, stop, is_loop=options["loop"])
            replay.run(_shown(islice(messages, options["count"]), pace, bag.length(), progress))
        stop.wait(options["hold"])
    for line in _wire_lines(replay):
        click.echo(line, err=True)
    for encoding, number in sorted(bag.others.items()):
        click.echo(f"{number} messages in {encoding} are not of ROS", err=True)
    is_damaged = _warn_if_damaged(recording, bag.fault, bag.reached)
    unread = any(_UNREAD in connection["drops"] for connection in replay.connections.values())
    return not (replay.refused or is_damaged or unread)


def _pause(pace: ReplayPace, key: str) -> None:
    if key == " ":
        pace.is_paused = not pace.is_paused


def _rounds(bag: Bag, pace: ReplayPace, stop: Event, *, is_loop: bool) -> Iterator[RosMessage]:
    """Yields the messages of a recording when their time has come, once or forever."""
    is_next = True
    while is_next and not stop.is_set():
        is_next = False
        for message in pace.messages(bag.messages()):
            is_next = is_loop
            yield message


def _shown(
    messages: Iterable[RosMessage], pace: ReplayPace, length: float | None, progress: Progress
) -> Iterator[RosMessage]:
    """Yields messages, and lets somebody at a terminal see how far they are."""
    progress.note = lambda: "paused" if pace.is_paused else f"{pace.position:.1f} s of it"
    for message in messages:
        if length:
            progress.at(pace.position / length)
        yield message


def _wire_lines(replay: WireReplay) -> Iterator[str]:
    """Yields the counts of the messages of a recording of ROS: published, dropped, not used."""
    for topic, number in sorted(replay.published.items()):
        yield f"{number} of {topic}"
    for name, counts in sorted(replay.connections.items()):
        drops = "".join(f", {number} {why}" for why, number in sorted(counts["drops"].items()))
        yield f"  {name}: {counts['passed']} to JAUS{drops}"
    for reason, number in sorted(replay.refused.items()):
        yield f"{number} not used: {reason}"
    for topic, number in sorted(replay.others.items()):
        yield f"{number} of {topic}, which no bridge takes"
    if replay.undefined:
        names = ", ".join(sorted(replay.undefined))
        yield f"the recording has no definition of the type of {names}: that of MODEL was used"


def _to_file(
    read: Model, paths: tuple[str, str, str], port: int, span: TimeSpan, *, force: bool, jaus: bool
) -> bool:
    """Writes the translation of a capture; returns whether all of it could be used."""
    from jausml.live.recording.captured import JausWriter
    from jausml.live.recording.mcap_files import McapFile
    from jausml.live.recording.translating import CaptureReplay, Translator
    from jausml.live.traffic.frames import UdpReader

    recording, model, output = paths
    catalogue = open_catalogue([model]) if jaus else None
    writer = JausWriter(catalogue) if catalogue is not None else None
    reader = UdpReader(port)
    faults: list[str] = []
    with Translator(read) as translator:
        with opened(recording) as source:
            frames = _readable(source, faults)
            first = list(islice(frames, 1))
            if faults:  # what cannot be read makes no file
                raise click.ClickException(f"{shown_path(recording)}: {faults[0]}")
            with written(output, force=force) as stream, McapFile(stream, has_jaus=jaus) as file:
                replay = CaptureReplay(translator, file, writer)
                datagrams = filter(None, map(reader.read, chain(first, frames)))
                replay.run(span.of(datagrams, lambda datagram: datagram.nanoseconds))
        skipped = _counted(replay.captured.skipped)
        for line in (*skipped_lines(reader, port), *skipped, *faults):
            click.echo(f"{shown_path(recording)}: {line}", err=True)
        is_complete = _show_results(replay, translator, writer, model)
    return is_complete and not faults


def _readable(stream: BinaryIO, faults: list[str]) -> Iterator[CapturedFrame]:
    """Yields the frames of a capture as far as it can be read; adds the fault at its end."""
    from jausml.live.traffic.captures import TrafficError, read_frames

    reached = None
    try:
        for frame in read_frames(stream):
            reached = frame.nanoseconds or reached
            yield frame
    except TrafficError as error:  # what was read before it counts
        until = "" if reached is None else f"; it was read until {shown_time(reached / _NANO)}"
        faults.append(f"{error}{until}")


def _counted(counts: dict[str, int]) -> Iterator[str]:
    for reason, number in sorted(counts.items()):
        yield f"skipped {number}: {reason}"


def _show_results(
    replay: CaptureReplay, translator: Translator, jaus: JausWriter | None, model: str
) -> bool:
    """Shows the counts of the messages; returns whether all that maps take became topics."""
    click.echo(f"{replay.captured.count} JAUS messages", err=True)
    for topic, number in sorted(replay.topics.items()):
        sources = replay.sources[topic]
        mixed = f", of {len(sources)} components together" if len(sources) > 1 else ""
        click.echo(f"  {number} on {topic}{mixed}", err=True)
    if translator.unmapped:
        click.echo(f"{sum(translator.unmapped.values())} for which there is no map:", err=True)
        for line in _named(translator.unmapped, model):
            click.echo(f"  {line}", err=True)
    for (label, reason), number in sorted(translator.untranslated.items()):
        example = translator.untranslated.examples[label, reason]
        example_note = f" ({example})" if example else ""
        click.echo(f"{label}: {number} not translated: {reason}{example_note}", err=True)
    for label, counts in translator.out_of_range().items():
        for what, number in sorted(counts.items()):
            click.echo(f"{label}: {number} values out of range: {what}", err=True)
    if jaus is not None:
        for reason, number in sorted(jaus.undecoded.items()):
            click.echo(f"{number} JAUS messages not written: {reason}", err=True)
    return not (translator.untranslated or (jaus is not None and jaus.undecoded))


def _named(codes: dict[int, int], model: str) -> Iterable[str]:
    """Yields the messages of codes, the most frequent first."""
    catalogue = open_catalogue([model])
    for code, number in sorted(codes.items(), key=lambda item: -item[1]):
        names = " or ".join(dict.fromkeys(message.name for message in catalogue.find(code)))
        yield f"{number} {names or 'unknown'} (0x{code:04X})"
