"""Elements by the texts and names that mean them, and what references may lead to."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any, TypeVar

from jausml.authoring.editing.commands import Command
from jausml.language.metamodel import ClassTable, FeatureTable
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import Document, Model, refs
from jausml.language.model.names import around, name_of
from jausml.language.model.values import suggest
from jausml.language.project import library, own_instances
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import outputs
from jausml.language.semantics.paths.markers import in_words
from jausml.language.semantics.paths.ros_paths import ros_name

FoundT = TypeVar("FoundT", bound="EObject")


class AnswerError(Exception):
    """A question that has no answer, in words for people."""


@dataclass(frozen=True)
class Scope:
    """A model as answers see it, and the rest of its project.

    `beside`: gives the model of the project's other files, which is read when it is needed.
    `with_maps`: whether ready maps are wanted: they are text, and half of reading the library.
    """

    model: Model
    root: Path
    beside: Callable[[], Model] | None = None
    with_maps: bool = True

    @property
    def library(self) -> Model:
        """The shipped library as far as it is wanted."""
        return library(with_maps=self.with_maps)

    @cached_property
    def _rest(self) -> tuple[Model, ...]:
        return () if self.beside is None else (self.beside(),)

    def instances(self, kind: type[FoundT]) -> list[FoundT]:
        """Returns the elements of a class: of the model, of the rest, and of the library."""
        return [*self.own(kind), *self.library.instances(kind)]

    def own(self, kind: type[FoundT]) -> list[FoundT]:
        """Returns the elements of a class in the model, then in the rest of the project."""
        return own_instances((self.model, *self._rest), kind)

    def ref(self, element: EObject | None) -> str:
        """Returns the text that names an element, empty for none and for what was not read."""
        return refs.ref_of(element, self.model_of(element), self._top)

    def find(self, ref: str) -> EObject:
        """Returns the element of a text, which may be one that the model does not use yet."""
        target = refs.find(ref, self.model, self._top)
        if target is None:
            others = (self.library,) if ref.startswith(refs.LIBRARY) else self._rest
            tried = (refs.find(ref, other, self._top) for other in others)
            target = next((element for element in tried if element is not None), None)
        if target is not None:
            return target
        raise AnswerError(f"there is no element {ref!r} any more")

    def model_of(self, element: EObject | None) -> Model:
        """Returns the model that has an element: this one, that of the library, or the rest."""
        if element is None or self.model.document_of(element) is not None:
            return self.model
        if self.library.document_of(element) is not None:
            return self.library
        having = (model for model in self._rest if model.document_of(element) is not None)
        return next(having, self.library)

    def find_in(self, document: Document, fragment: str) -> EObject:
        """Returns the element of a fragment in a document."""
        return self.find(f"{refs.file_of(document, self._top)}#{fragment}")

    @cached_property
    def _top(self) -> Path:
        return self.root.resolve()

    @property
    def file(self) -> str:
        """The file that was asked for."""
        return refs.file_of(self.model.documents[0], self._top)

    @property
    def is_text(self) -> bool:
        """Whether the file that was asked for is text and no XMI."""
        return self.model.documents[0].notation is not None


def label_of(element: EObject) -> str:
    """Returns how people name an element."""
    if isinstance(element, ros.MessageType | ros.ServiceType | ros.ActionType):
        return ros_name(element)
    owner = element.eContainer()
    if isinstance(element, jaus.MessageDef) and owner is not None:
        return f"{name_of(owner)}.{name_of(element)}"
    return name_of(element) or _by_what_it_says(element)


def _by_what_it_says(element: EObject) -> str:
    if isinstance(element, jaus.Transition):
        message = element.message
        trigger = name_of(message) if message is not None else element.event or "anything else"
        return f"{trigger} to {element.target}" if element.target else trigger
    if isinstance(element, ros.Marker):
        return in_words(element)
    if isinstance(element, bridge.OpenDecision) and element.text:
        return element.text
    target, source = getattr(element, "target", None), getattr(element, "source", None)
    if isinstance(target, str):
        return f"{source} -> {target}" if isinstance(source, str) else target
    return element.eClass.name


def service_of(scope: Scope, word: str) -> jaus.Service:
    """Returns the service of a name or URN, of several versions the newest.

    `AnswerError`: there is none, or services of several URNs have the name.
    """
    services = [
        service
        for service in scope.instances(jaus.Service)
        if word in (name_of(service), service.urn)
    ]
    urns = sorted({str(service.urn) for service in services})
    if len(urns) > 1:
        raise AnswerError(f"several services are named {word}: say which ({', '.join(urns)})")
    if not services:
        known = map(name_of, scope.instances(jaus.Service))
        raise _missing("service", word, known, f"'jausml new service {word}' makes one")
    return max(services, key=version_of)


def message_of(scope: Scope, word: str) -> jaus.MessageDef:
    """Returns the message of a name, or of a name behind that of its service and a dot."""
    service, _, name = word.rpartition(".")
    services = [service_of(scope, service)] if service else scope.instances(jaus.Service)
    by_urn: dict[str, jaus.MessageDef] = {}
    for owner in sorted(services, key=version_of):
        for message in (*owner.inputs, *owner.outputs):
            if name_of(message) == name:
                by_urn[str(owner.urn)] = message
    if len(by_urn) > 1:
        owners = ", ".join(sorted(f"{urn.rpartition(':')[2]}.{name}" for urn in by_urn))
        raise AnswerError(f"several services have a {name}: say which ({owners})")
    if not by_urn:
        names = (
            name_of(message) for owner in services for message in (*owner.inputs, *owner.outputs)
        )
        way = "'jausml new service' makes messages, 'jausml import jsidl' reads them"
        raise _missing("message", name, names, way)
    return next(iter(by_urn.values()))


def type_of(scope: Scope, word: str) -> ros.MessageType:
    """Returns the type of a name: of messages, as `geometry_msgs/Twist`, or of a part of calls.

    That is `std_srvs/SetBool.request`, for example, or `nav2_msgs/Wait.goal`.
    """
    return _ros_type(scope, ros.MessageType, word, "type")


def service_type_of(scope: Scope, word: str) -> ros.ServiceType:
    """Returns the service type of a name such as `std_srvs/Trigger`."""
    return _ros_type(scope, ros.ServiceType, word, "service type")


def action_type_of(scope: Scope, word: str) -> ros.ActionType:
    """Returns the action type of a name such as `nav2_msgs/FollowWaypoints`."""
    return _ros_type(scope, ros.ActionType, word, "action type")


RosTypeT = TypeVar("RosTypeT", ros.MessageType, ros.ServiceType, ros.ActionType)


def _ros_type(scope: Scope, kind: type[RosTypeT], word: str, what: str) -> RosTypeT:
    types = scope.instances(kind)
    name = plain_type(word)
    ros_type = next(
        (message_type for message_type in types if ros_name(message_type) == name), None
    )
    if ros_type is None:
        package = name.partition("/")[0]
        near = [
            type_name
            for type_name in map(ros_name, types)
            if type_name.partition("/")[0] == package
        ]
        # Of a package that is known nowhere, the names of others only lead astray.
        way = f"'jausml import ros {package}' brings that package into the project"
        raise _missing(f"ROS {what}", name, near, "" if near else way)
    return ros_type


def plain_type(word: str) -> str:
    """Returns the name of a ROS type without the folder that ROS writes between: `/msg/`."""
    package, _, rest = word.partition("/")
    folder, mark, name = rest.partition("/")
    return f"{package}/{name}" if mark and folder in ("msg", "srv", "action") else word


def version_of(service: jaus.Service) -> tuple[int, ...]:
    """Returns the version of a service, by which a newer one is greater."""
    return tuple(int(word) for word in str(service.version).split(".") if word.isdecimal())


def _missing(what: str, word: str, known: Iterable[str], otherwise: str = "") -> AnswerError:
    near = suggest(word, set(known))
    hint = f"{near} Else {otherwise}" if near and otherwise else near or otherwise
    return AnswerError(f"there is no {what} {word!r}{f'; {hint}' if hint else ''}")


def values_of(element: EObject, feature: FeatureTable) -> list[Any]:
    """Returns the values that an element has in a feature; none while the default holds."""
    value = getattr(element, feature.name)
    if feature.many:
        return list(value)
    is_unset = value is None or (
        not feature.is_reference and value == feature.default and not feature.can_be_missing
    )
    return [] if is_unset else [value]


def literal(value: Any) -> str:
    """Returns a value of a data type as models write it."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(getattr(value, "literal", None) or getattr(value, "name", value))


@dataclass(frozen=True, slots=True)
class Option:
    """A way to do the request; `preview`: its result, such as a statement."""

    label: str
    why: str
    commands: Sequence[Command]
    is_best: bool = False
    preview: str = ""


@dataclass(frozen=True, slots=True)
class Options:
    """All ways to do what was asked, the best first, or why there is none."""

    options: tuple[Option, ...] = ()
    refusal: str = ""


_OF_THE_SYSTEM = (jaus.Component, ros.Node, system.Host)


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the values that a field may have."""

    value: str
    label: str
    documentation: str = ""


def legal_targets(scope: Scope, element: EObject, feature: FeatureTable) -> tuple[Choice, ...]:
    """Returns the elements that a reference may lead to, in the order of their names."""
    table = scope.model.metamodels.class_of(element)
    for cls in table.supertypes:
        find = _NARROW.get(f"{cls.qualified_name}.{feature.name}")
        if find is not None and (narrow := find(element)) is not None:
            return _choices(scope, narrow)
    choices = everywhere(scope, feature.target, element)
    if feature.name == "query":
        query = getattr(element, "query", None)
        own = scope.ref(query) if query is not None else ""
        return tuple(
            choice
            for choice in choices
            if choice.value == own or choice.label.rpartition(".")[2].startswith("Query")
        )
    return choices


def everywhere(
    scope: Scope, target: ClassTable | None, element: EObject | None = None
) -> tuple[Choice, ...]:
    """Returns the elements of a class in the project and the library."""
    if target is None:
        return ()
    kind = target.python_class
    own = [candidate for candidate in scope.own(kind) if candidate is not element]
    if any(issubclass(kind, system_class) for system_class in _OF_THE_SYSTEM):
        whole = _system_of(element)
        return _choices(scope, [candidate for candidate in own if _system_of(candidate) is whole])
    if kind is jaus.Field:
        types = (
            field
            for service_set in scope.model.instances(jaus.ServiceSet)
            for field in service_set.types
        )
        return _choices(scope, [field for field in types if field is not element])
    return (*_choices(scope, own), *library_choices(target))


@cache
def library_choices(target: ClassTable) -> tuple[Choice, ...]:
    """Returns the elements of a class that the library has."""
    return _choices(Scope(library(), Path("/")), library().instances(target.python_class))


def _choices(scope: Scope, elements: Iterable[EObject]) -> tuple[Choice, ...]:
    labelled_elements = [(label_of(element), element) for element in elements]
    counts = Counter(label for label, _ in labelled_elements)
    # Of services of one name the newest comes first, with its messages.
    labelled_elements.sort(
        key=lambda entry: (entry[0].lower(), entry[0], [-part for part in _version(entry[1])])
    )
    return tuple(
        Choice(
            scope.ref(element),
            f"{label} ({_file(scope, element)})" if counts[label] > 1 else label,
            _first_sentence(str(getattr(element, "documentation", None) or "")),
        )
        for label, element in labelled_elements
    )


def _version(element: EObject) -> tuple[int, ...]:
    service = around(element, jaus.Service)
    return () if service is None else version_of(service)


def _first_sentence(text: str) -> str:
    return text.partition(". ")[0].removesuffix(".")


def _file(scope: Scope, element: EObject) -> str:
    document = scope.model.document_of(element)
    return document.path.stem if document is not None else ""


def _system_of(element: EObject | None) -> system.System | None:
    return around(element, system.System)


def _of_map(element: EObject, feature: str) -> list[EObject] | None:
    """Returns the elements of a feature of the map around an element, or of its connection."""
    map_or_connection: Any = around(element, bridge.AttributeMap, bridge.Connection)
    map_ = (
        map_or_connection.map
        if isinstance(map_or_connection, bridge.Connection)
        else map_or_connection
    )
    return None if map_ is None else list(getattr(map_, feature))


def _reports(element: EObject) -> list[EObject] | None:
    """Returns the messages that a service connection may ask for; all where none is chosen."""
    if not isinstance(element, jaus.ServiceConnection):
        return None
    provider = element.provider or element.search
    return None if provider is None else list(dict.fromkeys(outputs(provider)))


def _taken(element: EObject) -> list[EObject] | None:
    """Returns the messages that the service of a state machine takes, inherited ones included.

    What the runtime takes is no trigger (rule JML350).
    """
    service = around(element, jaus.Service)
    if service is None:
        return None
    is_served = service.urn in SERVED_BY_RUNTIME
    own = [
        ancestor
        for ancestor in lineage(service)
        if is_served or ancestor.urn not in SERVED_BY_RUNTIME
    ]
    return [message for ancestor in own for message in ancestor.inputs if name_of(message)]


_NARROW: Mapping[str, Callable[[EObject], list[EObject] | None]] = {
    "bridge.Conversion.table": partial(_of_map, feature="tables"),
    "bridge.Conversion.quantity": partial(_of_map, feature="quantities"),
    "bridge.Topic.join": partial(_of_map, feature="joins"),
    "bridge.ReportSource.join": partial(_of_map, feature="reportJoins"),
    "jaus.ServiceConnection.message": _reports,
    "jaus.Transition.message": _taken,
}
"""References that lead to fewer elements than those of their class."""
