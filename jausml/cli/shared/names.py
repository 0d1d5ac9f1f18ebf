"""Names that complete words: of the library, and of a project or of models that are named."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue

    Completing = Callable[[click.Context, click.Parameter, str], list[str]]


def completing(names: Callable[[Sequence[str]], Iterable[str]]) -> Completing:
    """Returns a completion of words by names, of which some come from the models of `--model`."""

    def fitting(context: click.Context, _parameter: click.Parameter, begun: str) -> list[str]:
        return beginning(begun, names(context.params.get("models") or ()))

    return fitting


def beginning(begun: str, names: Iterable[str]) -> list[str]:
    """Returns the names that begin as a word does, in order."""
    return sorted(name for name in set(names) if name.lower().startswith(begun.lower()))


def service_names(models: Sequence[str] = ()) -> Iterable[str]:
    """Returns the services."""
    return (service.name for service in _catalogue(models).services.values())


def message_names(models: Sequence[str] = ()) -> Iterable[str]:
    """Returns the messages."""
    return (
        name
        for service in _catalogue(models).services.values()
        for name in (*service.input_names, *service.output_names)
    )


def input_names(models: Sequence[str] = (), labels: Collection[str] = ()) -> Iterator[str]:
    """Yields the messages that services take, those that they inherit too.

    `labels`: URN and version of each service, e.g. `urn:jaus:jss:core:Management/1.1`; all services
    without any.
    """
    for service in _catalogue(models).services.values():
        if not labels or service.label in labels:
            for owner in service.lineage:
                yield from owner.input_names


def field_paths(name: str, models: Sequence[str] = ()) -> Iterator[str]:
    """Yields the paths of the fields of the messages of a name."""
    from jausml.live.messages import MessageError
    from jausml.live.messages.text import paths_of

    for message in _catalogue(models).named(name):
        try:
            yield from paths_of(message)
        except MessageError:
            continue  # Whoever uses it is told what is wrong.


def _catalogue(models: Sequence[str]) -> Catalogue:
    """Returns the known messages; models with faults are left out, as completion cannot say so."""
    from jausml.cli.shared.models import open_catalogue
    from jausml.live.messages.of_project import project_catalogue

    try:
        if models:
            return open_catalogue(models)
    except click.ClickException:
        pass
    return project_catalogue(lambda _: None)
