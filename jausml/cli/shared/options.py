"""Groups of verbs that load late, and options that several verbs have, each made once."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import reduce
from importlib import import_module
from typing import Any, TypeAlias

import click
from click.core import ParameterSource

from jausml.cli.shared.terminal import verbosity

Decorator: TypeAlias = "Callable[[Callable[..., Any]], Callable[..., Any]]"
OptionMaker: TypeAlias = "Callable[..., Decorator]"


# What options offer, without the modules that know more of it: they load slowly; tests compare.
TEXT_OR_JSON = ("text", "json")
"""For people, and for programs."""

SHELLS = ("bash", "zsh", "fish")
"""Shells that are completed for."""

COMPLETION = "_JAUSML_COMPLETE"
"""The variable by which a shell asks for completions; click makes its name of the program's."""

REPORT_FORMATS = ("text", "json", "junit", "sarif", "github")
"""`jausml.language.validation.formats`."""

CONFORMANCE_FORMATS = ("text", "json", "junit")
"""`jausml.live.peers.conformance.formats`."""

COMPETITIONS = ("igvc-jaus", "igvc-iop", "conformance")
"""`jausml.live.peers.judging.competitions`."""

MAKES = ("junior", "jts", "jaus++")
"""`jausml.live.peers.makes.rover`."""

QUESTIONS = ("heartbeat", "identification", "status", "control")
"""`jausml.live.peers.pinging`."""

AUTHORITY = 205
"""`jausml.live.peers.console`."""

STOP_WORDS = ("standby", "emergency")
"""`jausml.live.operating.stops`."""

TRANSPORTS = ("judp", "jtcp", "node-manager")
INTERFACE = "127.0.0.1"
PORT = 3794
GROUP = "239.255.0.1"
"""`jausml.live.peers.network`."""


class FiniteRange(click.FloatRange):
    """A number in a range, as click has it, which takes `nan` in any and `inf` without an end."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Returns the number, or tells that it is none."""
        number: float = super().convert(value, param, ctx)
        if not math.isfinite(number):
            self.fail(f"{value!r} is no finite number.", param, ctx)
        return number


def refuse_options(reason: str, *names: str) -> None:
    """Ends the verb where its command line states an option that has no effect.

    `reason`: beside what, such as `only with --listen`. `names`: those of the options, as the verb
    takes them.
    """
    context = click.get_current_context()
    stated = [
        option.opts[0]
        for option in context.command.params
        if option.name in names
        and context.get_parameter_source(option.name) is ParameterSource.COMMANDLINE
    ]
    if stated:
        raise click.UsageError(f"{', '.join(stated)}: {reason}")


def format_option(text: str, formats: tuple[str, ...] = TEXT_OR_JSON) -> Decorator:
    """Returns `--format`; the verb takes it as `output_format`."""
    return click.option(
        "--format", "output_format", type=click.Choice(formats), default=formats[0], help=text
    )


jobs_option = click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Processes that work at once; by default, one for each processor.",
)


def quiet_option(text: str) -> Decorator:
    """Returns `--quiet` of a verb, which is that in front of the verb too; taken as `quiet`."""
    return click.option(
        "-q",
        "--quiet",
        is_flag=True,
        help=text,
        callback=lambda _, __, value: value or verbosity().quiet,
    )


def _network_option(word: str, parameter: str, text: str, **attributes: Any) -> OptionMaker:
    """Returns a maker of an option of the JAUS network, by other names or with another text.

    By default it has the short name and that of generated processes.
    """

    def decorator(*names: str, text: str = text) -> Decorator:
        known = names or (f"--{word}", f"--jaus-{word}")
        return click.option(*known, parameter, help=text, **attributes)

    return decorator


interface_option = _network_option(
    "interface",
    "interface",
    "IPv4 address of the network interface of JAUS.",
    default=INTERFACE,
    metavar="ADDRESS",
)
port_option = _network_option(
    "port", "port", "UDP port of JUDP.", type=click.IntRange(1, 65535), default=PORT
)
multicast_group_option = _network_option(
    "multicast-group",
    "multicast_group",
    "Multicast group of JUDP.",
    default=GROUP,
    metavar="ADDRESS",
)
peer_option = _network_option(
    "peer",
    "peers",
    "Address of a component that multicast does not reach; may be repeated.",
    multiple=True,
    metavar="ID=HOST:PORT",
)


def adding(*options: Decorator) -> Decorator:
    """Returns a decorator that adds options, in their order."""
    return lambda function: reduce(lambda inner, add: add(inner), reversed(options), function)


place_options = adding(interface_option(), port_option(), multicast_group_option())
"""Adds the options of where JAUS is spoken."""
page_options = adding(
    click.option(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="Address to serve at; 127.0.0.1 is reachable from this computer only, others from the "
        "network.",
    ),
    click.option(
        "--port",
        "page_port",
        type=click.IntRange(0, 65535),
        default=0,
        show_default=False,
        metavar="PORT",
        help="Port to serve at; by default, a free one.",
    ),
    click.option("--no-browser", is_flag=True, help="Print the address without opening a browser."),
)
"""Adds the options of what serves a page: `host`, `page_port` and `no_browser`."""
page_network_options = adding(
    interface_option("--jaus-interface"),
    port_option("--jaus-port"),
    multicast_group_option("--jaus-multicast-group"),
    peer_option("--jaus-peer"),
)
"""Adds those of the JAUS network of what serves a page."""


class LazyGroup(click.Group):
    """Group with the places and the help of its verbs, which are loaded when they are used.

    A place is a module below `jausml.cli`, and behind a colon the name that the verb has in it if
    that is not `command`.
    """

    def __init__(self, *args: Any, verbs: Mapping[str, tuple[str, str]], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.verbs = verbs

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """Returns the verbs in the order of use."""
        return list(self.verbs)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Returns a verb, or None when there is none of the name."""
        if cmd_name not in self.verbs:
            return None
        module, _, name = self.verbs[cmd_name][0].partition(":")
        command: click.Command = getattr(import_module(f"jausml.cli.{module}"), name or "command")
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Writes the list of verbs, without loading them."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in self.verbs.items()])
