"""The palette: what can be added to a file, found by a few letters of its name."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import islice

from jausml.authoring.editing.commands import Add, Child, Command, Set
from jausml.authoring.proposals.bridging import bridges_of, map_commands, system_of
from jausml.authoring.proposals.elements import AnswerError, Scope, label_of, version_of
from jausml.authoring.proposals.new_elements import (
    PACKAGES,
    free_address,
    name_among,
    participant_name,
    usual_values,
)
from jausml.authoring.studio.views.forms import PaletteItem, kinds_of
from jausml.authoring.studio.views.service_lines import inherit
from jausml.language.metamodel import ClassTable, FeatureTable, documentation
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import around, name_of
from jausml.language.model.refs import LIBRARY
from jausml.language.project import library
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.names import in_words, snake_case, words
from jausml.language.semantics.paths.ros_paths import ros_name

MOST = 60
"""How many items are shown unless more are asked for."""

_MENTIONED = 3  # the rank of what has the words in its description alone

COMPONENTS, SERVICES, TYPES, MAPS, ELEMENTS = (
    "components",
    "services",
    "ros types",
    "ready maps",
    "elements",
)


@dataclass(frozen=True)
class Entry:
    """An entry of the palette before its place is known.

    `make`: makes the commands for a model and the element that it is dropped on, if any; nothing
    where it cannot go.
    """

    id: str
    group: str
    label: str
    note: str
    documentation: str
    make: Callable[[Scope, EObject | None], Sequence[Command]]
    words: str = ""

    def rank(self, wanted: Sequence[str]) -> int | None:
        """Returns the rank of the entry for some words, 0 best; None where it does not fit."""
        if not all(word in self.words for word in wanted):
            return None
        label = self.label.lower()
        if not wanted or label == wanted[0]:
            return 0
        if label.startswith(wanted[0]) or f" {wanted[0]}" in f" {self.words.split('|', 1)[0]}":
            return 1
        return 2 if wanted[0] in label else _MENTIONED


def palette(
    scope: Scope,
    query: str = "",
    kinds: Iterable[str] | None = None,
    limit: int = MOST,
    onto: str = "",
) -> list[PaletteItem]:
    """Returns the elements that can be added, the best first.

    What fits an element comes before what the system takes; without words to look for it leaves
    half of the room to that. Where something has the very name that is looked for, what only
    mentions it is left out. `kinds`: the groups that are meant, all when None. `onto`: names the
    element that it is dropped on. One that is gone, or of the library, takes nothing.
    """
    wanted = query.lower().split()
    groups = None if kinds is None else set(kinds)
    target = _target(scope, onto)
    turns: list[tuple[EObject | None, int]] = [(None, limit)]
    if target is not None:
        turns.insert(0, (target, limit if wanted else limit // 2))
    others = [_external(scope), *_own(scope), *library_entries()]
    ranked = [
        (element, most, _ranked([*_elements(scope, element), *others], wanted, groups))
        for element, most in turns
    ]
    is_named = any(rank == 0 for *_, entries in ranked for rank, _ in entries)
    items: list[PaletteItem] = []
    for element, most, entries in ranked:
        meant = (entry for rank, entry in entries if rank < _MENTIONED or not is_named)
        items += islice(_items(scope, meant, element), most - len(items))
    return items


def _target(scope: Scope, onto: str) -> EObject | None:
    """Returns the element that something is dropped on, None where that is the system."""
    if not onto or onto.startswith(LIBRARY):
        return None
    try:
        element = scope.find(onto)
    except AnswerError:  # it was chosen, and has gone meanwhile
        return None
    return None if element in scope.model.documents[0].roots else element


def _ranked(
    entries: Sequence[Entry], wanted: Sequence[str], groups: set[str] | None
) -> list[tuple[int, Entry]]:
    """Returns the entries of some groups that fit words with their ranks, the best first."""
    ranked = sorted(
        (rank, len(entry.label) if wanted else 0, index)
        for index, entry in enumerate(entries)
        if (groups is None or entry.group in groups) and (rank := entry.rank(wanted)) is not None
    )
    return [(rank, entries[index]) for rank, _, index in ranked]


def _items(scope: Scope, entries: Iterable[Entry], target: EObject | None) -> Iterator[PaletteItem]:
    """Yields the items that can be added to an element."""
    onto = label_of(target) if target is not None else ""
    for entry in entries:
        commands = entry.make(scope, target)
        if commands:
            yield PaletteItem(
                entry.id,
                entry.group,
                entry.label,
                entry.note,
                entry.documentation,
                commands,
                f"add {entry.label}",
                onto,
            )


@cache
def library_entries() -> tuple[Entry, ...]:
    """Returns the entries of the library, made at the first call."""
    model = library()
    return (
        *_services(model.instances(jaus.Service)),
        *_types(model.instances(ros.MessageType), model.instances(ros.ServiceType)),
        *_maps(model.instances(bridge.AttributeMap)),
    )


def _external(scope: Scope) -> Entry:
    """Returns the entry of a component that exists already."""
    table = scope.model.metamodels.classes["jaus.Component"]
    about = documentation(table.features["external"].feature)
    return _entry(
        "component external", COMPONENTS, "external component", "exists already", about,
        partial(_component, name="external", more={"external": ("true",)}),
    )  # fmt: skip


def _own(scope: Scope) -> Iterator[Entry]:
    """Yields the services, types and maps of the project."""
    yield from _services(scope.own(jaus.Service))
    yield from _types(scope.own(ros.MessageType), scope.own(ros.ServiceType))
    yield from _maps(scope.own(bridge.AttributeMap))


def _services(services: Iterable[jaus.Service]) -> Iterator[Entry]:
    for service in _ordered([known_service for known_service in services if known_service.urn]):
        family = str(service.urn).removesuffix(f":{name_of(service)}").rpartition(":")[2]
        where = f"{service.urn} {service.version}"
        names = " ".join(name_of(message) for message in (*service.inputs, *service.outputs))
        about = str(service.documentation or "")
        key = f"service {where}"
        component = partial(_component_with, service=service)
        yield _entry(
            f"{key} component", COMPONENTS, name_of(service),
            f"provides it, {family} {service.version}", about, component, where, names,
        )  # fmt: skip
        yield _entry(
            f"{key} inherits", SERVICES, name_of(service), f"inherits, {service.version}", about,
            partial(_inherited, base=service), where, names,
        )  # fmt: skip
        for feature in ("provides", "uses"):
            yield _entry(
                f"{key} {feature}", SERVICES, name_of(service), f"{feature}, {service.version}",
                about, partial(_with_service, service=service, feature=feature), where, names,
            )  # fmt: skip


def _ordered(services: Sequence[jaus.Service]) -> list[jaus.Service]:
    """Returns services in the order of search: those that move first, core services last.

    Every component has those. Older versions stand behind all that is present.
    """
    newest: dict[str, tuple[int, ...]] = {}
    for known_service in services:
        urn = str(known_service.urn)
        newest[urn] = max(newest.get(urn, ()), version_of(known_service))

    def place(service: jaus.Service) -> tuple[bool, int, str]:
        urn = str(service.urn)
        family = 0 if urn.startswith(_MOBILITY) else 2 if urn.startswith(CORE) else 1
        return version_of(service) < newest[urn], family, name_of(service)

    return sorted(services, key=place)


_MOBILITY = "urn:jaus:jss:mobility:"


def _types(
    messages: Iterable[ros.MessageType], services: Iterable[ros.ServiceType]
) -> Iterator[Entry]:
    ends = (
        ("publishers", "ros.Publisher", "publisher", "topic"),
        ("subscriptions", "ros.Subscription", "subscription", "topic"),
    )
    for message in messages:
        if isinstance(message.eContainer(), ros.InterfacePackage):
            for end in ends:
                yield _end(message, *end)
    for service in services:
        yield _end(service, "serviceServers", "ros.ServiceServer", "service server", "service")
        yield _end(service, "serviceClients", "ros.ServiceClient", "service client", "service")


def _end(
    kind: ros.MessageType | ros.ServiceType, feature: str, cls: str, noun: str, named: str
) -> Entry:
    make = partial(_endpoint, kind=kind, feature=feature, cls=cls, named=named)
    label = ros_name(kind)
    return _entry(f"{label} {feature}", TYPES, label, noun, str(kind.documentation or ""), make)


def _maps(maps: Iterable[bridge.AttributeMap]) -> Iterator[Entry]:
    for attribute_map in maps:
        if attribute_map.message is None or attribute_map.type is None or attribute_map.reportJoins:
            continue
        for to_ros, assignments in ((True, attribute_map.toRos), (False, attribute_map.toJaus)):
            if assignments:
                arrow = "to ROS" if to_ros else "to JAUS"
                ends = (name_of(attribute_map.message), ros_name(attribute_map.type))
                note = " to ".join(ends if to_ros else reversed(ends))
                make = partial(_connection, map_=attribute_map, to_ros=to_ros)
                about = str(attribute_map.documentation or "")
                yield _entry(
                    f"map {ends} {name_of(attribute_map)} {arrow}", MAPS,
                    name_of(attribute_map), note,
                    about, make, *ends,
                )  # fmt: skip


def _elements(scope: Scope, target: EObject | None) -> Iterator[Entry]:
    """Yields the kinds of elements that an element, the bridges or the system can own.

    A machine has the internal events of its service.
    """
    owners = list(_open_owners(scope)) if target is None else [target]
    service = around(target, jaus.Service)
    if service is not None and isinstance(target, jaus.StateMachine | jaus.State):
        owners.append(service)
    for owner in owners:
        table = scope.model.metamodels.class_of(owner)
        features = [
            containment
            for containment in table.contained
            if owner is not service or target is service or containment.name == "events"
        ]
        for feature in sorted(features, key=lambda feature: feature.name not in PACKAGES):
            is_full = not feature.many and getattr(owner, feature.name) is not None
            for kind in () if is_full or feature.target is None else kinds_of(feature.target):
                if kind.kind in _others(table, feature):
                    continue
                several = sum(inner.target is feature.target for inner in table.contained) > 1
                note = f"{in_words(feature.name)} of {label_of(owner)}"
                make = partial(_element, owner=owner, feature=feature, kind=kind.kind)
                label = in_words(feature.name) if several else kind.label
                entry = _entry(
                    f"element {feature.name} {kind.kind}", ELEMENTS, label, "",
                    kind.documentation, make, in_words(feature.name), kind.label,
                )  # fmt: skip
                yield replace(entry, note=note)  # nobody looks for it by the name of its owner


def _open_owners(scope: Scope) -> Sequence[EObject]:
    """Returns the possible owners of a new element while none is chosen: also a single bridge."""
    bridges = bridges_of(scope)
    return (*scope.model.documents[0].roots, *(bridges if len(bridges) == 1 else ()))


def _others(table: ClassTable, feature: FeatureTable) -> set[str]:
    """The classes that other features of a class are made for, such as bridges."""
    return {
        containment.target.qualified_name
        for containment in table.contained
        if containment.target is not None and containment.target is not feature.target
    }


def _entry(
    id_: str,
    group: str,
    label: str,
    note: str,
    about: str,
    make: Callable[[Scope, EObject | None], Sequence[Command]],
    *more: str,
) -> Entry:
    text = " ".join((label, " ".join(words(label)), *more, note))
    search_text = f"{' '.join(words(label))} {label}|{text} {about}".lower()
    return Entry(id_, group, label, note, about, make, search_text)


def _component_with(scope: Scope, onto: EObject | None, service: jaus.Service) -> Sequence[Command]:
    return _component(scope, onto, name_of(service), {"provides": (scope.ref(service),)})


def _component(
    scope: Scope, onto: EObject | None, name: str, more: Mapping[str, tuple[str, ...]]
) -> Sequence[Command]:
    whole = onto if isinstance(onto, system.System) else system_of(scope) if onto is None else None
    if whole is None:
        return []
    own = {"name": (participant_name(name, whole),), "address": (free_address(scope.model),)}
    return [Add(scope.ref(whole), "components", "jaus.Component", {**own, **more})]


def _with_service(
    scope: Scope, onto: EObject | None, service: jaus.Service, feature: str
) -> Sequence[Command]:
    if not isinstance(onto, jaus.Component):
        return []
    known = tuple(scope.ref(known_service) for known_service in getattr(onto, feature))
    own = scope.ref(service)
    return [] if own in known else [Set(scope.ref(onto), feature, (*known, own))]


def _inherited(scope: Scope, onto: EObject | None, base: jaus.Service) -> Sequence[Command]:
    if not isinstance(onto, jaus.Service):
        return []
    return [command for option in inherit(scope, onto, base).options for command in option.commands]


def _endpoint(
    scope: Scope,
    onto: EObject | None,
    kind: ros.MessageType | ros.ServiceType,
    feature: str,
    cls: str,
    named: str,
) -> Sequence[Command]:
    wanted = name_of(kind)
    type_ = (scope.ref(kind),)
    if isinstance(onto, ros.Node):
        name = name_among(wanted, getattr(onto, feature))
        values = {"name": (name,), named: (name,), "type": type_}
        return [Add(scope.ref(onto), feature, cls, values)]
    whole = onto if isinstance(onto, system.System) else system_of(scope) if onto is None else None
    if whole is None:
        return []
    name = snake_case(wanted)
    end = Child(feature, cls, {"name": (name,), named: (name,), "type": type_})
    node = {"name": (participant_name(f"{name}_node", whole),)}
    return [Add(scope.ref(whole), "nodes", "ros.Node", node, (end,))]


def _connection(
    scope: Scope, onto: EObject | None, map_: bridge.AttributeMap, *, to_ros: bool
) -> Sequence[Command]:
    if onto is not None and not isinstance(onto, bridge.Bridge | system.System):
        return []
    owner = onto or next(iter(bridges_of(scope)), None) or system_of(scope)
    return [] if owner is None else map_commands(scope, owner, map_, to_ros=to_ros)


def _element(
    scope: Scope, _: EObject | None, owner: EObject, feature: FeatureTable, kind: str
) -> Sequence[Command]:
    values = usual_values(scope.model, owner, feature, kind)
    return [Add(scope.ref(owner), feature.name, kind, values)]
