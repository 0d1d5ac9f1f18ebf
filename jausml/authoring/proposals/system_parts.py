"""New parts of a system as commands: bridges, components, nodes, and services of JAUS."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from jausml.authoring.editing.commands import NEW, Add, Child, Command, Set
from jausml.authoring.proposals.bridging import Draft, Offer, has_message, peer_of
from jausml.authoring.proposals.elements import AnswerError, Scope, label_of, service_of, type_of
from jausml.authoring.proposals.message_words import (
    COMMAND,
    QUERY,
    REPORT,
    MessageWish,
    message_of_words,
)
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
    """Returns what makes a bridge with a connection for each chosen way.

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
        services = [each.service for each in _offers(chosen) if each.is_provided is is_used]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    made = Add(scope.ref(whole), "bridges", "bridge.Bridge", values)
    return [made, *_connections(scope, f"{NEW}0", chosen, topics, first=1)]


def new_connections(
    scope: Scope, owner: bridge.Bridge, chosen: Sequence[Crossing], topics: Sequence[TopicEnd] = ()
) -> list[Command]:
    """Returns what adds a connection for each chosen way to a bridge, and the services of them."""
    place = scope.ref(owner)
    made: list[Command] = []
    for feature, is_used in (("provides", False), ("uses", True)):
        known = list(getattr(owner, feature))
        wanted = [each for each in _offers(chosen) if each.is_provided is is_used]
        missing = [each.service for each in wanted if not has_message(known, each.message)]
        if missing:
            refs = (scope.ref(each) for each in (*known, *missing))
            made.append(Set(place, feature, tuple(dict.fromkeys(refs))))
    return [*made, *_connections(scope, place, chosen, topics, owner)]


def _offers(chosen: Sequence[Crossing]) -> list[Offer]:
    """Returns what is exchanged with others."""
    return [each.offer for each in chosen if not each.is_own]


def _connections(
    scope: Scope,
    place: str,
    chosen: Sequence[Crossing],
    topics: Sequence[TopicEnd],
    owner: bridge.Bridge | None = None,
    *,
    first: int = 0,
) -> list[Command]:
    """Returns what makes a connection for each way, with the copies of maps that it needs.

    `owner`: the bridge at the place, None for a new one. `first`: the number of elements that are
    made before.
    """
    found: list[Command] = []
    names = [name_of(each) for each in owner.bridgeConnections] if owner is not None else []
    maps = [name_of(each) for each in owner.maps] if owner is not None else []
    fed: set[str] = set()
    for each in chosen:
        used = scope.ref(each.map)
        if each.has_own_map:
            maps.append(free_name(f"{each.topic.name}_{name_of(each.map)}", maps))
            before = first + sum(isinstance(one, Add) for one in found)
            used = f"{NEW}{before}"
            found += copied_with_names(
                scope, place, each.map, maps[-1], each.names, each.frames, first=before
            )
        names.append(free_name(_connection_name(each, chosen, names), names))
        draft = Draft(
            each.offer,
            peer_of(scope, each.offer) if each.offer.is_provided else None,
            each.map.type,
            each.map,
            each.topic.name,
            names[-1],
            each.qos,
            joins_of(each, topics, fed),
            each.hold_reason,
            each.is_own,
        )
        found.append(draft.connection(scope, place, used))
    return found


def _connection_name(crossing: Crossing, chosen: Sequence[Crossing], taken: Sequence[str]) -> str:
    """Returns the name of a connection: its topic's, or its map's where a topic has several."""
    own = snake_case(crossing.topic.name)
    is_shared = sum(each.topic.name == crossing.topic.name for each in chosen) > 1
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
    """Returns what makes a component."""
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (stated_or_free_address(scope.model, address),),
    }
    for feature, words in (("provides", provides), ("uses", uses)):
        services = [service_of(scope, each) for each in words]
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
    """Returns what makes a node of ROS."""
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

_BEGINS = {COMMAND: 0xD100, QUERY: 0xD200, REPORT: 0xD400}
_MOST = 0x100
_QUERY, _REPORT = "Query", "Report"
_COMMANDED, _REPORTING = "Management", "Events"
NOTHING = "none"
"""What a service inherits that stands for itself."""


def new_service(
    scope: Scope,
    whole: system.System | jaus.ServiceSet,
    name: str,
    messages: Sequence[str] = (),
    *,
    urn: str = "",
    inherits: str = "",
) -> Add:
    """Returns what makes a service: in a service set, or in a system with a set of its own.

    Args:
        messages: Its messages in words; without any it has a report and the query for it, as an
            example.
        urn: Its URN; empty for one of its name.
        inherits: Name or URN of the service that it inherits, `none` for none; empty for the core
            service that brings what its messages need.

    Raises:
        AnswerError: The name is none, there is no such service, one has the URN already, or the
            words or codes of messages are wrong.
    """
    if not is_identifier(name):
        raise AnswerError(f"{name!a} is no name: letters, digits and single _ after a letter")
    urn = urn or f"urn:example:{name_of(whole)}:{name}"
    known = scope.instances(jaus.Service)
    fault = urn_fault(urn)
    if fault:
        raise AnswerError(f"URN {show(urn)} {fault}; one is urn:example:sea:Sonar")
    if any(each.urn == urn for each in known):
        raise AnswerError(f"there is a service {urn} already")
    wishes = list(_with_queries([message_of_words(each) for each in messages] or [_example(name)]))
    names = Counter(each.name for each in wishes)
    if twice := next((each for each, count in names.items() if count > 1), None):
        raise AnswerError(f"two messages are named {twice}")
    values = {"name": (name,), "urn": (urn,), "version": (_VERSION,)}
    if inherits != NOTHING:
        is_commanded = any(each.kind == COMMAND for each in wishes)
        core = _COMMANDED if is_commanded else _REPORTING
        values["inherits"] = (scope.ref(service_of(scope, inherits or core)),)
    children = tuple(_coded(wishes, _codes(known)))
    if isinstance(whole, jaus.ServiceSet):
        return Add(scope.ref(whole), "services", "jaus.Service", values, children)
    service = Child("services", "jaus.Service", values, children)
    own = {
        "name": (free_name(name, map(name_of, whole.serviceSets)),),
        "version": (_VERSION,),
    }
    return Add(scope.ref(whole), "serviceSets", "jaus.ServiceSet", own, (service,))


def _example(name: str) -> MessageWish:
    """Returns the report that a service without messages begins with."""
    made = message_of_words(f"{_REPORT}{name}: Value percent 0..100")
    documentation = "An example: replace its field by what the service tells, with unit and range."
    return replace(made, documentation=documentation)


def _with_queries(wishes: Sequence[MessageWish]) -> Iterator[MessageWish]:
    """Yields messages, each report behind the query that asks for it."""
    names = {each.name for each in wishes}
    for each in wishes:
        query = f"{_QUERY}{each.name.removeprefix(_REPORT)}"
        if each.name.startswith(_REPORT) and query not in names:
            yield MessageWish(query, QUERY, documentation=f"Ask for {each.name}.")
        yield each


def _coded(wishes: Sequence[MessageWish], taken: dict[int, str]) -> Iterator[Child]:
    """Yields messages with their codes: those that are stated, and free ones.

    A query and its report have the same number behind what tells the kind.
    """
    for each in wishes:
        if each.code is not None:
            if each.code in taken:
                owner = taken[each.code]
                raise AnswerError(f"{each.name}: the code 0x{each.code:04X} is that of {owner}")
            taken[each.code] = each.name
    given = {each.subject: each.code % _MOST for each in wishes if each.code is not None}
    for each in wishes:
        number = each.code
        if number is None:
            number = _free(each.kind, taken, given.get(each.subject))
            given[each.subject] = number % _MOST
            taken[number] = each.name
        yield each.child(number)


def _free(kind: str, taken: Mapping[int, str], wanted: int | None) -> int:
    begin = _BEGINS[kind]
    if wanted is not None and begin + wanted not in taken:
        return begin + wanted
    numbers = range(1, _MOST)
    begins = _BEGINS.values()
    together = (begin + n for n in numbers if not any(each + n in taken for each in begins))
    anywhere = (each for each in range(_FIRST, _LAST + 1) if each not in taken)
    found = next(together, None) or next(anywhere, None)
    if found is None:
        raise AnswerError(f"no message code of 0x{_FIRST:04X} to 0x{_LAST:04X} is free")
    return found


def _codes(services: Iterable[jaus.Service]) -> dict[int, str]:
    """Returns the messages of services by their codes."""
    return {
        code(message): label_of(message)
        for each in services
        for message in (*each.inputs, *each.outputs)
    }
