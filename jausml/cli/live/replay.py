"""`jausml replay`: recordings through the maps of a model."""

from __future__ import annotations

import errno
import os
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml import installing
from jausml.cli.live.recordings import (
    force_option,
    not_itself,
    output_option,
    warn_if_damaged,
    written,
)
from jausml.cli.shared.files import PROBLEMS, STDIN, EnvironmentFault, shown_path
from jausml.cli.shared.models import bridge_options, only_system, valid_model
from jausml.cli.shared.options import FiniteRange, place_options, refuse_options

if TYPE_CHECKING:
    from jausml.live.recording.mcap_files import TimeSpan

# Options that only what goes to JAUS has.
_TO_JAUS = (
    *("interface", "multicast_group", "loop", "speed", "max_rate"),
    *("count", "wait", "hold", "allow_commands"),
)


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
@place_options
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
    from jausml.live.workers.worker import WorkerError

    span = TimeSpan(start, duration)
    if output is not None:
        not_itself(recording, output)
    if model is None and output is not None and recording.endswith(MCAP):
        others = ("with_jaus", "port", "bridge_address", *_TO_JAUS)
        refuse_options("not where an MCAP file is copied", *others)
        _copy(recording, output, span, force=force, ros_only=ros_only)
        return
    is_to_wire = is_bag(recording)
    if recording != STDIN and not Path(recording).exists():
        raise EnvironmentFault(f"{shown_path(recording)}: {os.strerror(errno.ENOENT)}")
    _check_ends(recording, model, output, is_bag=is_to_wire, with_jaus=with_jaus, ros_only=ros_only)
    if is_to_wire:
        refuse_options("only with --output", "force")
    else:
        refuse_options("only where a ROS recording goes to JAUS", *_TO_JAUS)
    model = model or only_system("MODEL")
    try:
        read = valid_model(model, Reading(bridge_address=bridge_address))
        if is_to_wire:
            from jausml.cli.live.replay_to_wire import to_wire

            is_done = to_wire(recording, read, span, options)
        else:
            from jausml.cli.live.replay_to_file import to_file

            port, path = options["port"], str(output)
            is_done = to_file(
                recording, path, model, read, port, span, force=force, with_jaus=with_jaus
            )
    except NoSystemError as error:
        hint = "--bridge-address ID makes a bridge of its maps"
        raise EnvironmentFault(f"{error}; {hint}") from error
    except (RecordingError, WorkerError, GenerationError) as error:
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


def _copy(recording: str, output: str, span: TimeSpan, *, force: bool, ros_only: bool) -> None:
    """Copies an MCAP file, or a part of it, as far as it can be read."""
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
    if warn_if_damaged(recording, source.fault, source.reached):
        raise click.exceptions.Exit(PROBLEMS)
