"""The network of the live verbs: its options, and an operator on it."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn

import click

from jausml.cli.shared.files import EnvironmentFault, ending_at
from jausml.cli.shared.models import explained, model_option, open_catalogue
from jausml.cli.shared.names import beginning, field_paths, input_names
from jausml.cli.shared.options import (
    TRANSPORTS,
    FiniteRange,
    adding,
    format_option,
    peer_option,
    place_options,
)
from jausml.cli.shared.terminal import remark, warn

if TYPE_CHECKING:
    from jausml.live.messages import MessageEntry
    from jausml.live.peers.network import Network
    from jausml.live.peers.operator import Operator
    from jausml.live.serving.server import Site
    from jausml.runtime.base.address import JausAddress

network_options = adding(
    click.option(
        "--id",
        "--jaus-id",
        "own_id",
        metavar="ID",
        help="JAUS id of this tool, subsystem.node.component; by default, a free one in subsystem "
        "65000.",
    ),
    place_options,
    peer_option(),
    model_option,
)
"""Adds the options that `network_from` and `open_catalogue` take."""

transport_options = adding(
    click.option(
        "--transport",
        "--jaus-transport",
        "transport",
        type=click.Choice(TRANSPORTS),
        default=TRANSPORTS[0],
        help="UDP, TCP, or the node manager of this host.",
    ),
    click.option(
        "--node-manager-directory",
        "--jaus-node-manager-directory",
        "node_manager_directory",
        default="",
        show_default=False,
        metavar="FOLDER",
        help="Folder of the local sockets of the node manager; by default, the one for temporary "
        "files.",
    ),
)
"""Adds the options that choose a transport."""

_NETWORK = (
    "own_id",
    "interface",
    "port",
    "multicast_group",
    "peers",
    "transport",
    "node_manager_directory",
)


waiting_options = adding(
    click.option(
        "--timeout", type=FiniteRange(0.05, 60), default=1.0, help="Seconds to wait for an answer."
    ),
    click.option(
        "--quiet-time",
        type=FiniteRange(0.02, 60),
        default=0.3,
        help="Seconds of silence that count as no answer.",
    ),
)
"""Adds the options of the times that a test waits for expected and unexpected messages."""


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Lets SIGTERM, and the end of the terminal, end a block like Ctrl-C: control is released."""
    former = signal.signal(signal.SIGTERM, signal.default_int_handler)
    terminals = [number for number in (1, 2) if os.isatty(number)]
    hang_up: int = getattr(signal, "SIGHUP", 0)  # Windows has none
    is_heeded = bool(hang_up) and signal.getsignal(hang_up) == signal.SIG_DFL

    def leave_terminal(number: int, _: FrameType | None) -> NoReturn:
        # Shells send it again, and writing to a terminal that has gone is an error.
        signal.signal(number, signal.SIG_IGN)
        nowhere = os.open(os.devnull, os.O_RDWR)
        for terminal in terminals:
            os.dup2(nowhere, terminal)
        raise KeyboardInterrupt

    if is_heeded:
        signal.signal(hang_up, leave_terminal)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, former)
        if is_heeded and signal.getsignal(hang_up) == leave_terminal:
            signal.signal(hang_up, signal.SIG_DFL)


@contextmanager
def identified_network(network: Network, count: int = 1) -> Iterator[Network]:
    """Yields the network with our id, and warns when another tool has it."""
    from jausml.live.peers.identity import identified

    with identified(network, count) as ours:
        if ours.is_shared:
            click.echo(
                f"warning: another jausml tool of this host has the id {ours.own} too, and answers "
                "may go there; without --id each has its own",
                err=True,
            )
        yield ours


def target_of(target: str, network: Network) -> JausAddress:
    """Returns the component that is tested, which is not on our own node."""
    from jausml.live.peers.network import component_address

    with ending_at(ValueError, kind=click.UsageError):
        address = component_address(target)
    if (address.subsystem, address.node) == (network.own.subsystem, network.own.node):
        raise click.UsageError(f"{target} is on the node of this tool; choose another --id")
    return address


def network_from(
    own_id: str | None,
    interface: str,
    port: int,
    multicast_group: str,
    peers: Sequence[str],
    **transport: str,
) -> Network:
    """Returns the network that the options describe, and keeps the runtime's log quiet.

    `own_id`: our JAUS id, None for a free one.
    """
    from jausml.live.peers.network import make_network, silence_log

    silence_log()
    with ending_at(ValueError, kind=click.UsageError):
        return make_network(own_id, interface, port, multicast_group, peers, **transport)


_REMEDY = (
    "To go through a node manager: --transport node-manager; or use another port and say where the "
    "components are: --port 3795 --peer ID=HOST:3794"
)


@dataclass(frozen=True)
class Settings:
    """Options that all commands of the operator share.

    `timeout`: seconds to wait for an answer.
    """

    network: Network
    models: tuple[str, ...]
    timeout: float
    as_json: bool

    @contextmanager
    def operator(self) -> Iterator[Operator]:
        """Yields an operator, whose errors end the verb."""
        from jausml.live.messages import MessageError
        from jausml.live.peers.network import fault
        from jausml.live.peers.operator import running_operator
        from jausml.live.peers.query_client import NoAnswer, Refused

        try:
            with (
                identified_network(self.network) as network,
                running_operator(network, open_catalogue(self.models), self.timeout) as operator,
            ):
                try:
                    yield operator
                finally:
                    for peer, learnt in operator.quirks():
                        remark(f"note: {peer} {learnt}")
                    if operator.is_impersonated:
                        warn(f"warning: another program of the network sends as {operator.own}")
        except NoAnswer as error:
            raise EnvironmentFault(str(error)) from error
        except Refused as error:
            raise click.ClickException(str(error)) from error
        except MessageError as error:
            raise click.UsageError(explained(error, self.models)) from error
        except OSError as error:
            raise EnvironmentFault(fault(error, self.network, _REMEDY)) from error

    def show(self, source: JausAddress, entry: MessageEntry, fields: dict[str, Any]) -> None:
        """Prints a report."""
        from jausml.live.peers import rendering

        render = rendering.report_json if self.as_json else rendering.report_line
        click.echo(render(source, entry, fields))


def parsed_address(_context: click.Context, _parameter: click.Parameter, value: str) -> JausAddress:
    """Returns the JAUS id of a component, as a callback of options and arguments."""
    from jausml.live.peers.network import component_address

    with ending_at(ValueError, kind=click.BadParameter):
        return component_address(value)


_FIELDS_BESIDE = "jausml.fields"
"""Where fields wait that stood in one object with the name of the message."""


def _message_name(context: click.Context, _parameter: click.Parameter, word: str) -> str:
    """Returns the name of a message; fields that stand beside it, as in `jausml encode`, wait."""
    if not word.lstrip().startswith("{"):
        return word
    from jausml.live.messages.field_paths import JsonError, parse_json

    try:
        content = parse_json(word)
    except JsonError as error:
        raise click.BadParameter(f"the message is no JSON: {error}") from error
    fields = content.get("fields", {})
    if not (isinstance(content.get("message"), str) and isinstance(fields, dict)):
        raise click.BadParameter('an object has a name as "message", and an object as "fields"')
    context.meta[_FIELDS_BESIDE] = fields
    return str(content["message"])


def _fields(
    context: click.Context, _parameter: click.Parameter, words: tuple[str, ...]
) -> dict[str, Any] | None:
    if not words:
        return context.meta.get(_FIELDS_BESIDE) or None
    if _FIELDS_BESIDE in context.meta:
        raise click.BadParameter("the fields stand in the object of the message already")
    from jausml.live.messages.field_paths import parse_fields

    with ending_at(ValueError, kind=click.BadParameter):
        return parse_fields(" ".join(words))


_COMPLETION_TIME = 0.7
"""Seconds that a component has to say what it provides while a person waits for a completion."""


def _message_names(context: click.Context, _parameter: click.Parameter, begun: str) -> list[str]:
    """Returns the messages that the named component takes; all that are known if it says none.

    The component is asked for its services, as `kubectl` and others do.
    """
    names = list(input_names(context.params.get("models") or (), _provided(context.params)))
    if context.info_name not in ("query", "watch"):
        return beginning(begun, names)
    queries = [name for name in names if name.startswith("Query")]
    return beginning(begun, (query.removeprefix("Query") for query in queries)) or beginning(
        begun, queries
    )


def _provided(parameters: dict[str, Any]) -> list[str]:
    """Returns URN and version of the services of the named component, none if it says none."""
    from jausml.live.peers.discovery import label_of, provided_services
    from jausml.live.peers.identity import identified

    try:
        peers = parameters.get("peers") or ()
        place = (parameters["interface"], parameters["port"], parameters["multicast_group"], peers)
        network = network_from(parameters.get("own_id"), *place)
        with identified(network) as ours:
            services = provided_services(ours, parameters["target"], _COMPLETION_TIME)
    except (KeyError, OSError, click.ClickException):
        return []  # a completion has nobody to tell it
    return [label_of(service) for service in services]


def _field_names(context: click.Context, _parameter: click.Parameter, begun: str) -> list[str]:
    """Returns the paths of the fields of the message that is named before, with their `=`."""
    parameters = context.params
    paths = field_paths(str(parameters.get("message")), parameters.get("models") or ())
    return beginning(begun, (f"{field_path}=" for field_path in paths))


TARGET = click.argument("target", metavar="ID", callback=parsed_address)
MESSAGE = click.argument(
    "message", metavar="MESSAGE", callback=_message_name, shell_complete=_message_names
)
FIELDS = click.argument(
    "fields", metavar="[FIELDS]...", nargs=-1, callback=_fields, shell_complete=_field_names
)


def operator_options(function: Callable[..., None]) -> Callable[..., None]:
    """Adds the shared options and hands them to the function as `Settings`."""

    @network_options
    @transport_options
    @click.option(
        "--timeout", type=FiniteRange(0.05, 600), default=3.0, help="Seconds to wait for an answer."
    )
    @format_option("Format of the output.")
    @wraps(function)
    def run(
        *arguments: Any, models: tuple[str, ...], timeout: float, output_format: str, **others: Any
    ) -> None:
        network = network_from(**{name: others.pop(name) for name in _NETWORK})
        settings = Settings(network, models, timeout, output_format == "json")
        function(*arguments, settings=settings, **others)

    return run


@contextmanager
def reaching(network: Network, remedy: str) -> Iterator[None]:
    """Tells why a component cannot be reached in a block.

    `remedy`: what to do when the port is in use.
    """
    from jausml.live.peers.conformance.run import TargetNotReached
    from jausml.live.peers.network import fault

    try:
        with ending_at(TargetNotReached):
            yield
    except OSError as error:
        raise EnvironmentFault(fault(error, network, remedy)) from error


def serve_page(host: str, port: int, site: Site, opened: Callable[[], None]) -> None:
    """Serves a page, or tells why it cannot be served; the arguments are those of `serve`."""
    from jausml.live.serving.server import PageMissingError, serve

    what = f"cannot serve at {host} port {port}: "
    with ending_at(PageMissingError), ending_at(OSError, ValueError, about=what):
        serve(host, port, site, opened)


@contextmanager
def until_interrupted() -> Iterator[None]:
    """Ends a block with Ctrl-C in good order, with control released."""
    try:
        with ended_by_signals():
            yield
    except KeyboardInterrupt:
        remark("interrupted")
