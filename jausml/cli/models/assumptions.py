"""Shared parts of the verbs that look at a whole system: reading it, and what they assume."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, TypeVar

import click

from jausml.cli.shared.files import EnvironmentFault
from jausml.cli.shared.models import valid_model

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.language.metamodel.classes.system import System
    from jausml.language.model.model import Model
    from jausml.language.validation.project import Reading
    from jausml.views.analysis.assumptions import Assumptions

Number = TypeVar("Number", int, float)

_LARGEST_RATE = 1e6
_LARGEST_LENGTH = 1 << 32
_MOST_DIGITS = 18


def assumption_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options of what a model does not say; the verb takes them as `assumptions`."""

    @click.option(
        "--assume-rate",
        "rates",
        multiple=True,
        metavar="[NAME=]HZ",
        help="Messages per second of topics and senders for which the model states no rate, 10 by "
        "default; with NAME or BRIDGE.NAME, of that connection. May be repeated.",
    )
    @click.option(
        "--assume-length",
        "lengths",
        multiple=True,
        metavar="[NAME=]N",
        help="Elements in unbounded lists, 100 by default; with NAME, in the messages of that "
        "connection. May be repeated.",
    )
    @functools.wraps(command)
    def with_assumptions(
        *arguments: object, rates: tuple[str, ...], lengths: tuple[str, ...], **others: object
    ) -> None:
        from jausml.views.analysis.assumptions import (
            DEFAULT_LENGTH,
            DEFAULT_RATE,
            Assumptions,
        )

        hertz = _named(rates, _rate)
        elements = _named(lengths, _length)
        assumptions = Assumptions(
            hertz.pop("", DEFAULT_RATE), elements.pop("", DEFAULT_LENGTH), hertz, elements
        )
        command(*arguments, assumptions=assumptions, **others)

    return with_assumptions


def read_system(path: str, reading: Reading) -> tuple[Model, System]:
    """Returns a valid model and the system of its file; what was found goes to stderr.

    Raises:
        EnvironmentFault: The file cannot be read, or has no system.
    """
    from jausml.generation.errors import NoSystemError
    from jausml.generation.system import system_of

    model = valid_model(path, reading)
    try:
        return model, system_of(model)
    except NoSystemError as error:
        raise EnvironmentFault(str(error)) from error


def check_names(assumptions: Assumptions, system: System) -> None:
    """Refuses assumptions about connections that a system does not have."""
    from jausml.views.analysis.assumptions import names_of

    known = {
        name
        for owner in (*system.components, *system.bridges)
        for each in (*owner.connections, *getattr(owner, "bridgeConnections", ()))
        for name in names_of(each)
    }
    for name in sorted(assumptions.names - known):
        raise click.UsageError(f"no connection {name!a} of which to assume something")


def _named(values: tuple[str, ...], parse: Callable[[str], Number]) -> dict[str, Number]:
    """Returns values by the names before them, the empty one for all."""
    found = {}
    for value in values:
        name, _, number = value.rpartition("=")
        found[name] = parse(number)
    return found


def _rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 0 < rate <= _LARGEST_RATE:
        raise click.UsageError(f"--assume-rate: {text!a} is no rate above 0 in hertz")
    return rate


def _length(text: str) -> int:
    length = whole_number(text)
    if length is None or length > _LARGEST_LENGTH:
        raise click.UsageError(f"--assume-length: {text!a} is no number of elements")
    return length


def whole_number(text: str) -> int | None:
    """Returns the number that digits say; None for other texts, and for more than a word holds."""
    is_number = text.isascii() and text.isdigit() and len(text) <= _MOST_DIGITS
    return int(text) if is_number else None
