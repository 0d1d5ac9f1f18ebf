"""Selection of interface packages, and of the JAUS messages that get a ROS message."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.semantics import calls
from jausml.language.semantics.core_services import CORE
from jausml_generators.common.components import with_inherited

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.model.model import Model


def declared_packages(model: Model) -> list[ros.InterfacePackage]:
    """Returns the interface packages that stand in the files that the user named."""
    packages = model.instances(ros.InterfacePackage, library=False)
    documents = [(package, model.document_of(package)) for package in packages]
    return [package for package, place in documents if place is not None and place.given]


def all_messages(model: Model) -> list[jaus.MessageDef]:
    """Returns the messages of all services of a model and of those that it uses."""
    own = model.instances(jaus.Service, library=False)
    return _messages([*own, *with_inherited(_used_services(model))])


def unmapped_messages(model: Model) -> list[jaus.MessageDef]:
    """Returns messages that no attribute map of the model is about.

    They are those of services that the model declares, and of the library's services that a
    component, a bridge or a connection uses, core services apart: the runtime speaks
    these.
    """
    mapped = {each.message for each in model.instances(bridge.AttributeMap)}
    own = model.instances(jaus.Service, library=False)
    used = [each for each in _used_services(model) if not str(each.urn).startswith(CORE)]
    return [each for each in _messages([*own, *used]) if each not in mapped]


def _messages(services: Iterable[jaus.Service]) -> list[jaus.MessageDef]:
    """Returns the messages of services, each once, those of one name and code by the first."""
    found: dict[tuple[str, str], jaus.MessageDef] = {}
    for service in dict.fromkeys(services):
        for message in (*service.inputs, *service.outputs):
            found.setdefault((str(message.name), str(message.code)), message)
    return list(found.values())


def _used_services(model: Model) -> Iterator[jaus.Service]:
    for component in model.instances(jaus.Component):
        yield from component.provides
        yield from component.uses
        for connection in component.connections:
            yield from _owners(connection.message, connection.query)
    for owner in model.instances(bridge.Bridge):
        for each in owner.bridgeConnections:
            yield from _owners(each.map.message, each.query)
        for each_call in owner.serviceConnections:
            yield from _owners(*calls.messages(each_call))
        for each_list in owner.actionConnections:
            yield each_list.driver
            yield from _owners(each_list.element.message)


def _owners(*messages: jaus.MessageDef | None) -> Iterator[jaus.Service]:
    owners = (message.eContainer() for message in messages if message is not None)
    yield from (owner for owner in owners if owner is not None)
