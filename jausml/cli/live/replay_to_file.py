"""Replay of captures of JAUS into MCAP files of ROS topics, through the maps of a model."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain, islice
from typing import BinaryIO

import click

from jausml.cli.live.recordings import opened, shown_time, skipped_lines, written
from jausml.cli.shared.files import shown_path
from jausml.cli.shared.models import open_catalogue
from jausml.language.model import Model
from jausml.live.recording.captured import JausWriter
from jausml.live.recording.mcap_files import McapFile, TimeSpan
from jausml.live.recording.translating import CaptureReplay, Translator
from jausml.live.traffic.captures import CapturedFrame, TrafficError, read_frames
from jausml.live.traffic.frames import UdpReader


def to_file(
    recording: str,
    output: str,
    model: str,
    read: Model,
    port: int,
    span: TimeSpan,
    *,
    force: bool,
    with_jaus: bool,
) -> bool:
    """Writes the translation of a capture; returns whether all of it could be used.

    Args:
        model: The path of the model.
        read: The same, read.
        force: Whether an output that is there is replaced.
        with_jaus: Whether the messages of JAUS are written too.
    """
    writer = JausWriter(open_catalogue([model])) if with_jaus else None
    reader = UdpReader(port)
    faults: list[str] = []
    with Translator(read) as translator:
        with opened(recording) as source:
            frames = _readable(source, faults)
            first = list(islice(frames, 1))
            if faults:  # what cannot be read makes no file
                raise click.ClickException(f"{shown_path(recording)}: {faults[0]}")
            with (
                written(output, force=force) as stream,
                McapFile(stream, has_jaus=with_jaus) as file,
            ):
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
    reached = None
    try:
        for frame in read_frames(stream):
            reached = frame.nanoseconds or reached
            yield frame
    except TrafficError as error:  # what was read before it counts
        until = "" if reached is None else f"; it was read until {shown_time(reached / 1e9)}"
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
