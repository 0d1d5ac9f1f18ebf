"""New parts of a system as commands: bridges, components, nodes, and services of JAUS."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from jausml.authoring.editing.commands import NEW, Add, Child, Command, Set
from jausml.authoring.proposals.bridging import Draft, Offer, has_message, peer_of
from jausml.authoring.proposals.elements import AnswerError, Scope, service_of, type_of
from jausml.authoring.proposals.named_elements import copied_with_names
from jausml.authoring.proposals.new_elements import free_name, stated_or_free_address
from jausml.authoring.proposals.topics import Crossing, TopicEnd, joins_of
from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.model.names import name_of
from jausml.language.model.values import show
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.names import is_identifier, snake_case, urn_fault


def new_bridge(
    scope: Scope,
    whole: system.System,
    name: str,
    chosen: Sequence[Crossing],
    *,
    topics: Sequence[TopicEnd] = (),
    address: str = "",
    namespace: str = "",
) -> list[Command]:
    """Returns the commands that make a bridge with a connection for each chosen way.

    `topics`: all topics, which may feed the joins of maps. `address`: its JAUS id; empty for one
    that is free. `namespace`: where the names of its topics are resolved; empty for the root.
    """
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (stated_or_free_address(scope.model, address),),
    }
    if namespace:
        values["namespace"] = (namespace,)
    for feature, is_used in (("provides", False), ("uses", True)):
        services = [offer.service for offer in _offers(chosen) if offer.is_provided is is_used]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    bridge_command = Add(scope.ref(whole), "bridges", "bridge.Bridge", values)
    return [bridge_command, *_connections(scope, f"{NEW}0", chosen, topics, first=1)]


def new_connections(
    scope: Scope, owner: bridge.Bridge, chosen: Sequence[Crossing], topics: Sequence[TopicEnd] = ()
) -> list[Command]:
    """Returns the commands that add a connection for each chosen way, and the services of them."""
    place = scope.ref(owner)
    commands: list[Command] = []
    for feature, is_used in (("provides", False), ("uses", True)):
        known = list(getattr(owner, feature))
        wanted = [offer for offer in _offers(chosen) if offer.is_provided is is_used]
        missing = [offer.service for offer in wanted if not has_message(known, offer.message)]
        if missing:
            refs = (scope.ref(service) for service in (*known, *missing))
            commands.append(Set(place, feature, tuple(dict.fromkeys(refs))))
    return [*commands, *_connections(scope, place, chosen, topics, owner)]


def _offers(chosen: Sequence[Crossing]) -> list[Offer]:
    """Returns the messages that are exchanged with others."""
    return [crossing.offer for crossing in chosen if not crossing.is_own]


def _connections(
    scope: Scope,
    place: str,
    chosen: Sequence[Crossing],
    topics: Sequence[TopicEnd],
    owner: bridge.Bridge | None = None,
    *,
    first: int = 0,
) -> list[Command]:
    """Returns the commands that add a connection for each way, with the copies of maps it needs.

    `owner`: the bridge at the place, None for a new one. `first`: the number of elements that are
    made before.
    """
    commands: list[Command] = []
    names = (
        [name_of(bridge_connection) for bridge_connection in owner.bridgeConnections]
        if owner is not None
        else []
    )
    maps = [name_of(attribute_map) for attribute_map in owner.maps] if owner is not None else []
    fed: set[str] = set()
    for crossing in chosen:
        used = scope.ref(crossing.map)
        if crossing.has_own_map:
            maps.append(free_name(f"{crossing.topic.name}_{name_of(crossing.map)}", maps))
            before = first + sum(isinstance(command, Add) for command in commands)
            used = f"{NEW}{before}"
            commands += copied_with_names(
                scope, place, crossing.map, maps[-1], crossing.names, crossing.frames, first=before
            )
        names.append(free_name(_connection_name(crossing, chosen, names), names))
        draft = Draft(
            crossing.offer,
            peer_of(scope, crossing.offer) if crossing.offer.is_provided else None,
            crossing.map.type,
            crossing.map,
            crossing.topic.name,
            names[-1],
            crossing.qos,
            joins_of(crossing, topics, fed),
            crossing.hold_reason,
            crossing.is_own,
        )
        commands.append(draft.connection(scope, place, used))
    return commands


def _connection_name(crossing: Crossing, chosen: Sequence[Crossing], taken: Sequence[str]) -> str:
    """Returns the name of a connection: its topic's, or its map's where a topic has several."""
    own = snake_case(crossing.topic.name)
    is_shared = (
        sum(chosen_crossing.topic.name == crossing.topic.name for chosen_crossing in chosen) > 1
    )
    return snake_case(name_of(crossing.map)) if is_shared or own in taken else own


def new_component(
    scope: Scope,
    whole: system.System,
    name: str,
    *,
    provides: Iterable[str] = (),
    uses: Iterable[str] = (),
    address: str = "",
    simulated: bool = False,
) -> Add:
    """Returns the command that adds a component."""
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (stated_or_free_address(scope.model, address),),
    }
    for feature, words in (("provides", provides), ("uses", uses)):
        services = [service_of(scope, word) for word in words]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    if simulated:
        values["simulated"] = ("true",)
    return Add(scope.ref(whole), "components", "jaus.Component", values)


def new_node(
    scope: Scope,
    whole: system.System,
    name: str,
    *,
    publishes: Iterable[tuple[str, str]] = (),
    subscribes: Iterable[tuple[str, str]] = (),
) -> Add:
    """Returns the command that adds a node of ROS."""
    ends: list[Child] = []
    for feature, kind, topics in (
        ("publishers", "ros.Publisher", publishes),
        ("subscriptions", "ros.Subscription", subscribes),
    ):
        names: list[str] = []
        for topic, word in topics:
            names.append(free_name(topic, names))
            type_ = scope.ref(type_of(scope, word))
            values = {"name": (names[-1],), "topic": (topic,), "type": (type_,)}
            ends.append(Child(feature, kind, values))
    return Add(scope.ref(whole), "nodes", "ros.Node", {"name": (name,)}, tuple(ends))


_VERSION = "1.0"
_FIRST, _LAST = 0xD000, 0xFFFF
"""Codes that AS5684 leaves to users."""

_COMMANDS = 0xD100
_QUERY, _REPORT = "Query", "Report"
_BEGINS = {_QUERY: 0xD200, _REPORT: 0xD400, "Confirm": 0xD400, "Reject": 0xD400}
"""Where the codes of messages begin, by the word that begins their name."""

_MOST = 0x100
_COMMANDED, _REPORTING = "Management", "Events"
NOTHING = "none"
"""The word for no service to inherit."""

_MESSAGE = "jaus.MessageDef"


def new_service(
    scope: Scope,
    whole: system.System | jaus.ServiceSet,
    name: str,
    messages: Sequence[str] = (),
    *,
    urn: str = "",
    inherits: str = "",
) -> Add:
    """Returns the command that adds a service: to a service set, or to a system with its own set.

    Args:
        messages: The names of its messages; without any it has a report and the query for it, as
            an example.
        urn: Its URN; empty for one of its name.
        inherits: Name or URN of the service that it inherits, `none` for none; empty for the core
            service that brings what its messages need.

    Raises:
        AnswerError: The name is none, there is no such service, one has the URN already, or the
            name of a message is none, or stands twice.
    """
    if not is_identifier(name):
        raise AnswerError(f"{name!r} is no name: letters, digits and single _ after a letter")
    urn = urn or f"urn:example:{name_of(whole)}:{name}"
    known = scope.instances(jaus.Service)
    fault = urn_fault(urn)
    if fault:
        raise AnswerError(f"URN {show(urn)} {fault}; one is urn:example:sea:Sonar")
    if any(known_service.urn == urn for known_service in known):
        raise AnswerError(f"there is a service {urn} already")
    messages = messages or [f"{_REPORT}{name}"]
    for message, count in Counter(messages).items():
        if not is_identifier(message):
            raise AnswerError(f"{message!r} is no name of a message, such as ReportDepth")
        if count > 1:
            raise AnswerError(f"two messages are named {message}")
    names = list(_with_queries(messages))
    values = {"name": (name,), "urn": (urn,), "version": (_VERSION,)}
    if inherits != NOTHING:
        is_commanded = any(_begin(message) == _COMMANDS for message in names)
        core = _COMMANDED if is_commanded else _REPORTING
        values["inherits"] = (scope.ref(service_of(scope, inherits or core)),)
    children = tuple(_coded(names, _codes(known)))
    if isinstance(whole, jaus.ServiceSet):
        return Add(scope.ref(whole), "services", "jaus.Service", values, children)
    service = Child("services", "jaus.Service", values, children)
    own = {"name": (free_name(name, map(name_of, whole.serviceSets)),), "version": (_VERSION,)}
    return Add(scope.ref(whole), "serviceSets", "jaus.ServiceSet", own, (service,))


def _with_queries(names: Sequence[str]) -> Iterator[str]:
    """Yields messages, each report behind the query that asks for it."""
    for name in names:
        query = f"{_QUERY}{name.removeprefix(_REPORT)}"
        if name.startswith(_REPORT) and query not in names:
            yield query
        yield name


def _coded(names: Sequence[str], taken: set[int]) -> Iterator[Child]:
    """Yields messages with free codes; a query and its report have the same last octet."""
    octets: dict[str, int] = {}
    for name in names:
        subject = _subject(name)
        code = _free(_begin(name), taken, octets.get(subject))
        octets[subject] = code % _MOST
        taken.add(code)
        yield _message(name, code)


def _begin(name: str) -> int:
    """Returns the first code of messages of a kind, by the first word of a name."""
    return next((code for word, code in _BEGINS.items() if name.startswith(word)), _COMMANDS)


def _subject(name: str) -> str:
    """Returns the subject of a message: its name without the word that says the kind."""
    prefix = next((word for word in (*_BEGINS, "Set") if name.startswith(word)), "")
    return name.removeprefix(prefix) or name


def _message(name: str, code: int) -> Child:
    """Returns a message; a report has an example of a field."""
    values = {"name": (name,), "code": (f"0x{code:04X}",)}
    begin = _begin(name)
    if begin == _COMMANDS:
        values["isCommand"] = ("true",)
    if not name.startswith(_REPORT):
        return Child("outputs" if begin == _BEGINS[_REPORT] else "inputs", _MESSAGE, values)
    values["documentation"] = (
        "An example: replace its field by what the service tells, with unit and range.",
    )
    limits = Child("scale", "jaus.ScaleRange", {"lower": ("0.0",), "upper": ("100.0",)})
    field = {"name": ("Value",), "type": ("uint16",), "units": ("percent",)}
    fields = (Child("fields", "jaus.FixedField", field, (limits,)),)
    record = {"name": (f"{_subject(name)}Rec",)}
    return Child("outputs", _MESSAGE, values, (Child("body", "jaus.Record", record, fields),))


def _free(begin: int, taken: set[int], octet: int | None) -> int:
    if octet is not None and begin + octet not in taken:
        return begin + octet
    begins = (_COMMANDS, *_BEGINS.values())
    together = (
        offset
        for offset in range(1, _MOST)
        if taken.isdisjoint(base_code + offset for base_code in begins)
    )
    number = next(together, None)
    if number is not None:
        return begin + number
    code = next((index for index in range(_FIRST, _LAST + 1) if index not in taken), None)
    if code is None:
        raise AnswerError(f"no message code of 0x{_FIRST:04X} to 0x{_LAST:04X} is free")
    return code


def _codes(services: Iterable[jaus.Service]) -> set[int]:
    """Returns the codes of the messages of services."""
    return {
        code(message) for service in services for message in (*service.inputs, *service.outputs)
    }
