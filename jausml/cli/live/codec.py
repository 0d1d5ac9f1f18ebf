"""`jausml decode` and `jausml encode`: JAUS messages from hex, captures or live, and as hex."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.live.recordings import opened, skipped_lines, transport_settings
from jausml.cli.shared.files import (
    FORMATS,
    PROBLEMS,
    STDIN,
    ending_at,
    read_lines,
    shown_path,
    to_json,
    write,
)
from jausml.cli.shared.models import explained, model_option, open_catalogue
from jausml.cli.shared.options import (
    FiniteRange,
    interface_option,
    multicast_group_option,
    port_option,
    refuse_options,
)

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue, DecodedMessage
    from jausml.live.traffic.frames import Datagram
    from jausml.live.traffic.observing import Observation

_BYTE = re.compile(r"(?:0[xX])?[0-9A-Fa-f]{2}")

_PART = re.compile(r"(?:0[xX])?(?:[0-9A-Fa-f]{2}){1,14}")
"""Hex that is too short for a datagram: one byte before the message, and its header of 14."""

_NAMED = re.compile(r"[A-Za-z]\w*\s+(\{|[\w.\[\]]+=)")
"""A message with fields, as `jausml ocu` takes them."""

_ARGUMENT = "argument "

_BEGINNING = 1024  # bytes of a file that tell whether it is text

Line = tuple[str, str]
"""Where a line stands, and its text."""


@click.command("decode")
@click.argument("inputs", nargs=-1, metavar="[HEX...|FILE|-]")
@click.option("--datagram", is_flag=True, help="Read the hex as whole JUDP datagrams with headers.")
@click.option(
    "--pcap", metavar="FILE", help="Read a capture (pcap or pcapng, also gzipped); - reads stdin."
)
@click.option("--listen", is_flag=True, help="Listen to the multicast group without taking part.")
@click.option(
    "--service",
    metavar="SERVICE",
    help="Service whose message to decode, if a code has several meanings: URN or name, "
    "optionally with /VERSION.",
)
@click.option(
    "--message", metavar="NAME", help="Message to decode, if a code has several meanings even then."
)
@click.option(
    "--format",
    "output_format",
    type=FORMATS,
    help="Indented text with units, or one JSON object per line; by default, text on a terminal "
    "and JSON otherwise.",
)
@click.option(
    "--numbers", is_flag=True, help="In JSON, write the numbers of named values, not their names."
)
@model_option
@port_option(text="For --pcap and --listen: UDP port of JUDP.")
@interface_option(text="For --listen: IPv4 address of the network interface.")
@multicast_group_option(text="For --listen: multicast group of JUDP.")
@click.option(
    "--count", type=click.IntRange(1), help="End after this number of messages or datagrams."
)
@click.option(
    "--duration", type=FiniteRange(0), metavar="S", help="Listen for this number of seconds."
)
def decode(
    inputs: tuple[str, ...],
    datagram: bool,
    pcap: str | None,
    listen: bool,
    service: str | None,
    message: str | None,
    output_format: str | None,
    numbers: bool,
    models: tuple[str, ...],
    count: int | None,
    **options: Any,
) -> None:
    """Show JAUS messages: from hex in arguments, files or stdin, from captures, or live.

    A line of hex is one message: its code, low byte first, and its body. It may contain blanks,
    colons, 0x and comments (#). Several arguments with hex bytes make one message.

    Exit status: 0 done, 1 something cannot be decoded (the rest is shown), 2 usage or unreadable
    input, 3 internal error.
    """
    if sum((bool(inputs), pcap is not None, listen)) > 1:
        raise click.UsageError("give one of HEX or FILE, --pcap, and --listen")
    if listen or pcap is not None:
        refuse_options("only with hex", "datagram")
    else:
        refuse_options("only with --pcap or --listen", "port")
    if not listen:
        refuse_options("only with --listen", "interface", "multicast_group", "duration")
    by_default = "text" if sys.stdout.isatty() else "json"
    output = _Output(output_format or by_default, are_numbers=numbers)
    catalogue = open_catalogue(models)
    _check_meaning(catalogue, service, message)
    reading = _Reading(catalogue, (service, message), output, count)
    if listen:
        reading.network(**options)
    elif pcap is not None:
        reading.capture(pcap, options["port"])
    else:
        reading.lines(_lines(inputs, are_datagrams=datagram), are_datagrams=datagram)
    if output.has_failed:
        raise click.exceptions.Exit(PROBLEMS)


def _lines(inputs: tuple[str, ...], *, are_datagrams: bool) -> Iterator[Line]:
    """Yields the lines of arguments and files; stdin when there are none."""
    if not inputs and sys.stdin.isatty():
        raise click.UsageError("give HEX, a FILE, - for stdin, --pcap or --listen")
    part = _PART if are_datagrams else _BYTE
    if len(inputs) > 1 and all(map(part.fullmatch, inputs)):
        yield "arguments", " ".join(inputs)
        return
    for number, text in enumerate(inputs or (STDIN,), 1):
        if text == STDIN or _is_file(text):
            _refuse_capture(text)
            for line_number, line in enumerate(read_lines(text), 1):
                yield f"{shown_path(text)}:{line_number}", line
        else:
            yield f"{_ARGUMENT}{number}", text


def _is_file(text: str) -> bool:
    try:
        return bool(text) and Path(text).exists()
    except (OSError, ValueError):
        return False


def _refuse_capture(path: str) -> None:
    """Refuses a capture where hex is wanted."""
    from jausml.live.traffic.captures import is_capture

    # What is no plain file, such as a pipe, gives its bytes only once.
    if path != STDIN and Path(path).is_file():
        with ending_at(OSError, about=f"{shown_path(path)}: "), Path(path).open("rb") as stream:
            beginning = stream.read(_BEGINNING)
        if is_capture(beginning[:4]):
            raise click.UsageError(f"{shown_path(path)} is a capture, no hex: use --pcap")
        if b"\0" in beginning:
            raise click.UsageError(f"{shown_path(path)} is neither text with hex nor a capture")


class _Output:
    """Writes decoded messages."""

    def __init__(self, output_format: str, *, are_numbers: bool = False) -> None:
        self.has_failed = False
        self._are_numbers = are_numbers
        self._is_json = output_format == "json"

    def message(self, decoded: DecodedMessage) -> None:
        """Writes a message."""
        from jausml.live.messages import text as message_text

        if self._is_json:
            self._write(decoded.to_json())
            return
        write(message_text.title(decoded))
        for line in message_text.lines(decoded):
            write(f"  {line}")

    def observation(self, observation: Observation, place: str) -> None:
        """Writes a message with its transport header, or a datagram that cannot be read.

        `place`: where its line of hex stands, empty for captures and live traffic.
        """
        self.has_failed |= bool(observation.error)
        located = {"place": place} if place and observation.error else {}
        if located:
            click.echo(f"{place}: {observation.error}", err=True)
        if self._is_json:
            self._write({**observation.to_json(), **located})
            return
        from jausml.live.traffic import observing

        for line in observing.lines(observation):
            write(line)

    def _write(self, content: dict[str, Any]) -> None:
        from jausml.live.messages.values import as_numbers

        write(to_json(as_numbers(content) if self._are_numbers else content))

    def problem(self, place: str, reason: str) -> None:
        """Writes why a line cannot be decoded: to stderr, and for programs to stdout."""
        self.has_failed = True
        click.echo(f"{place}: {reason}", err=True)
        if self._is_json:
            write(to_json({"error": reason, "place": place}))


def _check_meaning(catalogue: Catalogue, service: str | None, message: str | None) -> None:
    """Refuses an unknown service or message, before any input is read."""
    from jausml.live.messages import AmbiguousMessageError, MessageError

    try:
        if service is not None:
            catalogue.find_services(service)
        if message is not None:
            catalogue.message(message, service)
    except AmbiguousMessageError:
        return  # the bytes may tell
    except MessageError as error:
        raise click.UsageError(str(error)) from error


@dataclass(frozen=True)
class _Reading:
    """Reader of one source, which shows its messages."""

    _catalogue: Catalogue
    _meaning: tuple[str | None, str | None]
    _output: _Output
    _count: int | None

    def lines(self, lines: Iterable[Line], *, are_datagrams: bool) -> None:
        """Shows lines of hex: payloads, or datagrams with their headers."""
        from jausml.live.messages import MessageError

        placed_bytes = islice(self._bytes(lines), self._count)
        if are_datagrams:
            from jausml.live.traffic.frames import Datagram

            self._observe((place, Datagram(data)) for place, data in placed_bytes)
            return
        for place, payload in placed_bytes:
            try:
                self._output.message(self._catalogue.decode(payload, *self._meaning))
            except MessageError as error:
                from jausml.live.traffic.frames import is_judp

                hint = "; it has the form of a datagram: --datagram" if is_judp(payload) else ""
                self._output.problem(place, f"{error}{hint}")

    def _bytes(self, lines: Iterable[Line]) -> Iterator[tuple[str, bytes]]:
        """Yields the bytes of lines that have some."""
        from jausml.live.traffic.captures import TrafficError, parse_hex

        for place, line in lines:
            try:
                data = parse_hex(line)
            except TrafficError as error:
                is_argument = place.startswith(_ARGUMENT)
                hint = "neither a file nor hex: " if is_argument else ""
                self._output.problem(place, f"{hint}{error}")
                continue
            if data:
                yield place, data

    def _observe(self, datagrams: Iterable[tuple[str, Datagram]], *, is_live: bool = False) -> None:
        from jausml.live.traffic.observing import Observer

        observer = Observer(self._catalogue, *self._meaning)
        for place, datagram in datagrams:
            for observation in observer.observe(datagram):
                self._output.observation(observation, place)
            if is_live:
                sys.stdout.flush()
        if observer.host_frames:
            what = f"skipped {observer.host_frames} frames between jausml processes of one host"
            click.echo(what, err=True)

    def capture(self, path: str, port: int) -> None:
        """Shows the JUDP traffic of a capture."""
        from jausml.live.traffic.captures import TrafficError, read_frames
        from jausml.live.traffic.frames import UdpReader

        reader = UdpReader(port)
        with opened(path) as stream:
            captured_datagrams = filter(None, map(reader.read, read_frames(stream)))
            datagrams = (("", datagram) for datagram in captured_datagrams)
            try:
                self._observe(islice(datagrams, self._count), is_live=path == STDIN)
            except TrafficError as error:
                self._output.problem(shown_path(path), str(error))
        for line in skipped_lines(reader, port):
            click.echo(f"{shown_path(path)}: {line}", err=True)

    def network(
        self, port: int, interface: str, multicast_group: str, duration: float | None
    ) -> None:
        """Shows the messages that the multicast group is sent."""
        from jausml.live.traffic.captures import TrafficError
        from jausml.live.traffic.listening import MulticastListener

        settings = transport_settings(interface, port, multicast_group)
        with ending_at(TrafficError):
            listener = MulticastListener(settings)
        with listener:
            click.echo(f"listening to {multicast_group}:{port} on {interface}", err=True)
            try:
                heard = islice(listener.datagrams(duration), self._count)
                self._observe((("", datagram) for datagram in heard), is_live=True)
            except KeyboardInterrupt:
                click.echo("interrupted", err=True)


@click.command("encode")
@click.argument("words", nargs=-1, metavar="[JSON|NAME FIELDS|FILE|-]")
@model_option
def encode(words: tuple[str, ...], models: tuple[str, ...]) -> None:
    """Turn messages in JSON into hex, one message per line.

    A line of a file, or an argument, is an object as `jausml decode --format json` prints it:
    "message" (name) or "code", "fields", and a "service" (with "service_version") if several
    messages have the name. `_pv`, and the name of the one record of a body, may be omitted. A line
    can also be the name of the message and its fields, as `jausml ocu` takes them. Without an
    argument, reads stdin.

    Exit status: 0 done, 1 a line is wrong (the others are encoded), 2 usage or an unreadable file,
    3 internal error.
    """
    from jausml.live.messages import MessageError

    failed = False
    catalogue = open_catalogue(models)
    path = " ".join(words) or STDIN
    is_message = len(words) > 1 or path.lstrip().startswith("{") or _is_named(path)
    name = "argument" if is_message else shown_path(path)
    for number, line in enumerate([path] if is_message else read_lines(path), 1):
        if not line.strip():
            continue
        try:
            write(catalogue.encode(_message(line)).hex())
        except (MessageError, _LineError) as error:
            failed = True
            click.echo(f"{name}:{number}: {explained(error, models)}", err=True)
    if failed:
        raise click.exceptions.Exit(PROBLEMS)


def _is_named(text: str) -> bool:
    """Tells whether an argument is the name of a message with fields, and no file."""
    return _NAMED.match(text) is not None and not _is_file(text)


class _LineError(ValueError):
    """A line that is not an object of JSON."""


def _message(line: str) -> dict[str, Any]:
    from jausml.live.messages.field_paths import JsonError, parse_fields, parse_json
    from jausml.live.messages.values import shown

    name, _, fields = line.strip().partition(" ")
    if name.isidentifier() and name not in ("null", "true", "false"):
        try:
            return {"message": name, "fields": parse_fields(fields) if fields.strip() else {}}
        except ValueError as error:
            raise _LineError(str(error)) from error
    try:
        value = parse_json(line.rstrip())
    except JsonError as error:
        raise _LineError(str(error)) from error
    if isinstance(value, dict) and isinstance(value.get("message"), dict):
        value = value["message"]  # a line of `jausml decode --datagram`
    if not isinstance(value, dict):
        raise _LineError(f"an object is needed, this is {shown(value)}")
    return value
