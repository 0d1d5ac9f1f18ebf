"""`jausml replay`: captures through the maps of a model into an MCAP file."""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

import click

from jausml.cli.captures import opened, skipped_lines
from jausml.cli.common import (
    PROBLEMS,
    EnvironmentFault,
)
from jausml.cli.messages import open_catalogue, shown_path
from jausml.cli.recordings import force_option, output_option, valid_model, written

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.live.traffic.captures import Frame
    from jausml.recording.from_captures import CaptureReplay, JausWriter
    from jausml.recording.translating import Translator


@click.command("replay")
@click.argument("recording", metavar="RECORDING")
@click.argument("model", metavar="MODEL")
@output_option
@force_option
@click.option(
    "--with-jaus",
    is_flag=True,
    help="Have the JAUS messages in FILE too, as JSON; ros2 bag does not play such a file.",
)
@click.option(
    "--port", "--jaus-port", "port", default=3794, show_default=True, help="UDP port of JAUS."
)
def command(
    recording: str,
    model: str,
    output: str | None,
    force: bool,
    with_jaus: bool,
    port: int,
) -> None:
    """Replay recordings through the maps of MODEL.

    RECORDING is a capture: pcap, pcapng, or - for stdin. Each message that a bridge of MODEL would
    take is translated as the bridge does it, and stands in FILE with the time at which it was
    captured. So does what such a bridge has sent itself, where its map has both directions.
    Foxglove, PlotJuggler and `ros2 bag play` open FILE.

    Of a file of maps without a system all maps are used, for the messages of anybody, each on a
    topic of its name.

    Exit status: 0 done, 1 problems in the model, in the capture or in what is in it (the rest is
    done), 2 usage or environment, 3 internal error.
    """
    from jausml.generation import GenerationError
    from jausml.recording.errors import RecordingError
    from jausml.recording.from_captures import CaptureReplay, JausWriter
    from jausml.recording.mcap_writing import McapFile
    from jausml.recording.translating import Translator

    if output is None:
        raise click.UsageError("say with --output which file is written")
    catalogue = open_catalogue([model]) if with_jaus else None
    read = valid_model(model)
    try:
        with (
            Translator(read) as translator,
            written(output, force=force) as stream,
            McapFile(stream, has_jaus=with_jaus) as file,
        ):
            jaus = JausWriter(file, catalogue) if catalogue is not None else None
            replay = CaptureReplay(translator, file, jaus)
            is_whole = _replayed(replay, recording, port)
            is_complete = _told(replay, translator, jaus, model)
    except (RecordingError, GenerationError) as error:
        raise EnvironmentFault(str(error)) from error
    if not (is_whole and is_complete):
        raise click.exceptions.Exit(PROBLEMS)


def _replayed(replay: CaptureReplay, path: str, port: int) -> bool:
    """Reads a capture; returns whether it could be read to its end."""
    from jausml.live.traffic.captures import read_frames
    from jausml.live.traffic.errors import TrafficError
    from jausml.live.traffic.frames import UdpReader

    reader = UdpReader(port)
    faults: list[str] = []

    def readable(stream: BinaryIO) -> Iterator[Frame]:
        try:
            yield from read_frames(stream)
        except TrafficError as error:  # what was read before it counts
            faults.append(str(error))

    with opened(path) as stream:
        replay.run(filter(None, map(reader.read, readable(stream))))
    for line in (*skipped_lines(reader, port), *_counted(replay.captured.skipped), *faults):
        click.echo(f"{shown_path(path)}: {line}", err=True)
    return not faults


def _counted(counts: dict[str, int]) -> Iterator[str]:
    for reason, number in sorted(counts.items()):
        yield f"skipped {number}: {reason}"


def _told(
    replay: CaptureReplay, translator: Translator, jaus: JausWriter | None, model: str
) -> bool:
    """Tells what became of the messages; returns whether those that maps take all became topics."""
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
        told = f" ({example})" if example else ""
        click.echo(f"{label}: {number} not translated: {reason}{told}", err=True)
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
    for code, number in sorted(codes.items(), key=lambda each: -each[1]):
        names = " or ".join(dict.fromkeys(each.name for each in catalogue.find(code)))
        yield f"{number} {names or 'unknown'} (0x{code:04X})"
