"""Elements by the words that people say: services, messages and types of a model or the library."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from jausml.authoring.proposals.elements import AnswerError, library
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.model.names import name_of
from jausml.language.model.values import suggest
from jausml.language.semantics.ros_paths import ros_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml.authoring.proposals.elements import Scope
    from jausml.language.metamodel.classes.ecore import EObject

FoundT = TypeVar("FoundT", bound="EObject")


def service_of(scope: Scope, word: str) -> jaus.Service:
    """Returns the service of a name or URN, of several versions the newest.

    Raises:
        AnswerError: There is none, or services of several URNs have the name.
    """
    found = [each for each in _all(scope, jaus.Service) if word in (name_of(each), each.urn)]
    urns = sorted({str(each.urn) for each in found})
    if len(urns) > 1:
        raise AnswerError(f"several services are named {word}: say which ({', '.join(urns)})")
    if not found:
        raise _missing("service", word, map(name_of, _all(scope, jaus.Service)))
    return max(found, key=_version)


def message_of(scope: Scope, word: str) -> jaus.MessageDef:
    """Returns the message of a name, or of a name behind that of its service and a dot."""
    service, _, name = word.rpartition(".")
    services = [service_of(scope, service)] if service else _all(scope, jaus.Service)
    by_urn: dict[str, jaus.MessageDef] = {}
    for each in sorted(services, key=_version):
        for message in (*each.inputs, *each.outputs):
            if name_of(message) == name:
                by_urn[str(each.urn)] = message
    if len(by_urn) > 1:
        owners = ", ".join(sorted(f"{each.rpartition(':')[2]}.{name}" for each in by_urn))
        raise AnswerError(f"several services have a {name}: say which ({owners})")
    if not by_urn:
        names = (name_of(m) for each in services for m in (*each.inputs, *each.outputs))
        raise _missing("message", name, names)
    return next(iter(by_urn.values()))


def type_of(scope: Scope, word: str) -> ros.MessageType:
    """Returns the message type of a name such as `geometry_msgs/Twist`."""
    types = [
        each
        for each in _all(scope, ros.MessageType)
        if isinstance(each.eContainer(), ros.InterfacePackage)
    ]
    name = word.replace("/msg/", "/", 1)
    found = next((each for each in types if ros_name(each) == name), None)
    if found is None:
        raise _missing("ROS type", name, map(ros_name, types), "jausml import ros makes others")
    return found


def _all(scope: Scope, kind: Callable[..., FoundT]) -> list[FoundT]:
    own: list[FoundT] = [
        each
        for model in (scope.model, *scope.others)
        for each in model.instances(kind, library=False)  # type: ignore[arg-type]
    ]
    return [*own, *library().instances(kind)]  # type: ignore[arg-type]


def _version(service: jaus.Service) -> tuple[int, ...]:
    return tuple(int(each) for each in str(service.version).split(".") if each.isdecimal())


def _missing(what: str, word: str, known: Iterable[str], otherwise: str = "") -> AnswerError:
    hint = suggest(word, set(known)) or otherwise
    return AnswerError(f"there is no {what} {word!a}{f'; {hint}' if hint else ''}")
