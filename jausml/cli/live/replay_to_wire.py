"""Replay of ROS recordings to the JAUS network, through the bridges of a model."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import islice
from threading import Event
from typing import Any

import click

from jausml.cli.live.recordings import warn_if_damaged
from jausml.cli.shared.files import shown_path
from jausml.cli.shared.terminal import Progress, pressed, step
from jausml.language.model import Model
from jausml.live.recording.bags import Bag, RosMessage
from jausml.live.recording.mcap_files import TimeSpan
from jausml.live.recording.to_wire import ReplayPace, WireReplay
from jausml.live.signals import ended_by_signals

# How bridges count messages that are none of their type.
_UNREAD = "not_decodable"


def to_wire(recording: str, model: Model, span: TimeSpan, options: dict[str, Any]) -> bool:
    """Gives a recording of ROS to bridges; returns whether all that they take could be used.

    Args:
        options: Those of `jausml replay` for the network and the pace, by their names in Python.
    """
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
    is_damaged = warn_if_damaged(recording, bag.fault, bag.reached)
    unread = any(_UNREAD in connection["drops"] for connection in replay.connections.values())
    return not (replay.refused or is_damaged or unread)


def _pause(pace: ReplayPace, key: str) -> None:
    if key == " ":
        pace.is_paused = not pace.is_paused


def _rounds(bag: Bag, pace: ReplayPace, stop: Event, *, is_loop: bool) -> Iterator[RosMessage]:
    """Yields the messages of a recording when their time has come, once or forever."""
    is_next = True  # but an empty recording is not gone through again
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
