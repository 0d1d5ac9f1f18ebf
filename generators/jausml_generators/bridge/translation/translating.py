"""The translations of a bridge: the methods of its connections, and all that they use.

Connections of one map, or of maps that differ in names of frames and of messages, share theirs: it
is made once without these names, and given those of each.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from typing import NamedTuple

from jausml.language.metamodel.classes import bridge, ecore, jaus
from jausml.language.metamodel.classes.ecore import EClass, EObject
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.stops import has_stop
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import used_maps
from jausml_generators.bridge.light_module import LightModule
from jausml_generators.bridge.translation.maps import stop, to_jaus, to_ros
from jausml_generators.bridge.translation.printing import OWN_NAMES, printed
from jausml_generators.bridge.translation.steps import Step
from jausml_generators.bridge.translation.surroundings import Surroundings
from jausml_generators.bridge.translation.translation import Frames, frame_assignments, frames_of
from jausml_generators.common.ros import RosClasses
from jausml_generators.cpp.core import Compiled, Core, Ends
from jausml_generators.python.codec.message_builder import build_unnamed
from jausml_generators.python.codec.messages import FORM_CLASS, MessageView
from jausml_generators.python.names import Scope, names_in, snake_case
from jausml_generators.python.statements import may_set_limits

# Control characters stand in no name, and in literals only as escapes.
_NAME = "\1"  # stands for the name of a connection


@dataclass
class _UnnamedSurroundings(Surroundings):
    """Surroundings of a translation that many connections share.

    Where each connection has an attribute of its own, a mark stands for the name of that.

    Attributes:
        claims: By mark, what claims the attribute, from the surroundings of the bridge, the name
            of a connection and the frames of its map.
    """

    claims: list[Callable[[Surroundings, str, Frames], str]] = field(default_factory=list)

    def frame(self, connection: str, path: str, value: str) -> str:  # noqa: ARG002 - none yet
        """Returns the mark for the attribute of the name of a frame."""
        return self._marked(
            lambda uses, name, frames: uses.frame(name, path, frames.get(path, value))
        )

    def memory(self, name: str, annotation: str) -> str:
        """Returns the mark for the attribute that keeps a value."""
        return self._marked(
            lambda uses, connection, _: uses.memory(name.replace(_NAME, connection), annotation)
        )

    def _marked(self, claim: Callable[[Surroundings, str, Frames], str]) -> str:
        self.claims.append(claim)
        return _mark(len(self.claims) - 1)


class _SharedTranslation(NamedTuple):
    """The body of a method without names of connections, frames and messages.

    Attributes:
        compiled: Its functions in the compiled core, by message.
    """

    text: str
    steps: tuple[Step, ...]
    surroundings: _UnnamedSurroundings
    compiled: dict[jaus.MessageDef, Compiled | None]


@dataclass(frozen=True)
class _TranslationRequest:
    """The translation that a connection needs, and the functions that make its steps and lines.

    Attributes:
        make_steps: Returns the steps for the name of a connection, a message and surroundings.
    """

    name: str
    message: MessageView
    attribute_map: bridge.AttributeMap
    make_steps: Callable[[str, MessageView, Surroundings], tuple[Step, ...]]
    print_steps: Callable[[tuple[Step, ...]], tuple[str, ...]]
    compile_steps: Callable[[tuple[Step, ...]], Compiled | None]


_Printed = tuple[tuple[str, ...], "Compiled | None"]
"""A translation as the lines of a method, and as a function of the compiled core."""


class SharedTranslations:
    """The translations of one bridge, by a key of those that differ in names alone."""

    def __init__(self, uses: Surroundings) -> None:
        self._uses = uses
        self._shared: dict[object, _SharedTranslation] = {}

    def translation(self, key: object, request: _TranslationRequest) -> _Printed:
        """Returns a translation with the names of the connection that requests it."""
        if key not in self._shared:
            self._shared[key] = self._unnamed(request)
        shared, element = self._shared[key], request.attribute_map.message
        if element not in shared.compiled:
            shared.compiled[element] = request.compile_steps(shared.steps)
        frames = frames_of(request.attribute_map)
        attributes = [
            claim(self._uses, request.name, frames) for claim in shared.surroundings.claims
        ]

        def named(text: str) -> str:
            for number, attribute in enumerate(attributes):
                text = text.replace(_mark(number), attribute)
            return text.replace(_NAME, request.name).replace(FORM_CLASS, request.message.class_name)

        compiled = shared.compiled[element]
        lines = tuple(named(shared.text).split("\n"))
        return lines, None if compiled is None else compiled.renamed(named)

    def _unnamed(self, request: _TranslationRequest) -> _SharedTranslation:
        # The very collections of the bridge, no copies: what is made here counts for all of it.
        collections = {item.name: getattr(self._uses, item.name) for item in fields(self._uses)}
        surroundings = _UnnamedSurroundings(**collections)
        steps = request.make_steps(_NAME, build_unnamed(request.message), surroundings)
        return _SharedTranslation("\n".join(request.print_steps(steps)), steps, surroundings, {})


def _mark(number: int) -> str:
    return f"\2{number}\3"


_SAYS_NOTHING = frozenset({"name", "documentation", "message"})
"""Features of a map that are in no translation; of the message its form is."""


class AlikeMaps:
    """The maps of a bridge by what they say, the names of their frames and messages left out."""

    def __init__(self, view_of: Callable[[jaus.MessageDef], MessageView]) -> None:
        self._view_of = view_of
        self._features: dict[EClass, list[tuple[str, bool]]] = {}
        self._first: dict[bridge.AttributeMap, bridge.AttributeMap] = {}
        self._by_content: dict[Hashable, bridge.AttributeMap] = {}
        self._frames: set[EObject] = set()

    def first(self, attribute_map: bridge.AttributeMap) -> bridge.AttributeMap:
        """Returns the first map, of those seen so far, that says the same.

        They may differ in their own names, in those of frames, which are parameters, and in the
        names and codes of their messages, if these are of one service and laid out alike.
        """
        if attribute_map not in self._first:
            self._frames.update(frame_assignments(attribute_map))
            # The tests of vectors name the map.
            name = attribute_map.name if attribute_map.vectors else None
            own = self._values(attribute_map, _SAYS_NOTHING)
            key = (name, own, self._form(attribute_map.message))
            self._first[attribute_map] = self._by_content.setdefault(key, attribute_map)
        return self._first[attribute_map]

    def _form(self, message: jaus.MessageDef) -> Hashable:
        # What is made of limits only a message of a standard says, by its name.
        named = message if may_set_limits(message) else None
        return message.eContainer(), named, self._view_of(message).form

    def _values(self, element: EObject, without: frozenset[str] = frozenset()) -> Hashable:
        kind = element.eClass
        if kind not in self._features:
            features = kind.eAllStructuralFeatures()
            self._features[kind] = [
                (feature.name, feature.many) for feature in features if feature.name not in without
            ]
        key_parts: list[Hashable] = [kind]
        for name, is_many in self._features[kind]:
            # Names of frames are parameters, so maps that differ in nothing else share their code.
            if name == "value" and element in self._frames:
                continue
            value = getattr(element, name)
            said = [self._said(element, item) for item in (value if is_many else [value])]
            key_parts.append(tuple(said))
        return tuple(key_parts)

    def _said(self, owner: EObject, value: Hashable) -> Hashable:
        """Returns the contents of a value; an element that is only referred to is itself."""
        if isinstance(value, ecore.EObject) and value.eContainer() is owner:
            return self._values(value)
        return value


# Attributes that the base class has anyway, or had: names in the code of users stay.
_TAKEN_ATTRIBUTES = names_in(
    """
    accept at clients clock close compiled component connections core core_services decide_handoff
    fast_subscriber
    fast_translation follow frozen_at guardian_stopped is_active loop note_guardian note_unasked now
    on_control_lost on_handoff_requested on_not_ready open parameters publisher report ros
    set_active settings
    shared_messages shared_topics simulation standing subscribe ward
    """
)


@dataclass(frozen=True)
class TranslatedJoin:
    """A joined message as a parameter: in Python, `name` may differ from the model's."""

    join: bridge.Join | bridge.ReportJoin
    name: str
    type_name: str


@dataclass(frozen=True)
class Translated:
    """The methods of one connection.

    Attributes:
        lines: The statements that make `target` from `source`.
        safe_lines: The statements that return what is sent when the source is lost; none without a
            safe value.
        compiled: Its function in the compiled core; None where Python alone has it.
    """

    name: str
    ros_name: str
    joins: tuple[TranslatedJoin, ...]
    lines: tuple[str, ...]
    safe_lines: tuple[str, ...]
    alike: Hashable
    compiled: Compiled | None


@dataclass(frozen=True)
class TranslatedCall:
    """The methods of one service connection.

    Attributes:
        halves: Its halves that maps translate, as connections, with their translations.
    """

    name: str
    request_name: str
    response_name: str
    halves: Mapping[str, tuple[bridge.Connection, Translated]]


@dataclass(frozen=True)
class Translations:
    """All translations of a bridge.

    Attributes:
        connections: Those of the connections, in model order.
        calls: Those of the service connections, in model order.
    """

    connections: tuple[Translated, ...]
    calls: tuple[TranslatedCall, ...]
    uses: Surroundings
    ros_classes: RosClasses
    core: Core


def translate(
    element: bridge.Bridge,
    connections: Sequence[bridge.Connection],
    view_of: Callable[[jaus.MessageDef], MessageView],
    taken: Iterable[str],
    light: LightModule,
) -> Translations:
    """Translates the connections of a bridge."""
    ros_classes = RosClasses(taken)
    overrides = {str(quantity.name): quantity for quantity in element.quantities}
    methods = _methods_of([*connections, *element.serviceConnections])
    attributes = Scope(_TAKEN_ATTRIBUTES | methods)
    uses = Surroundings(view_of, ros_classes.name_of, overrides, attributes)
    names = [attributes.claim(snake_case(connection.name)) for connection in connections]
    ros_names = [ros_classes.name_of(connection.map.type) for connection in connections]
    core = Core(light, ros_classes, uses)
    translator = _Translator(uses, SharedTranslations(uses), AlikeMaps(view_of), core)
    translated = tuple(map(translator.connection, connections, names, ros_names))
    services = element.serviceConnections
    call_names = [attributes.claim(snake_case(service.name)) for service in services]
    translated_calls = tuple(map(translator.call, services, call_names))
    return Translations(translated, translated_calls, uses, ros_classes, core)


def _methods_of(
    connections: Iterable[bridge.Connection | bridge.RosServiceConnection],
) -> frozenset[str]:
    """Returns the methods that connections may have, which no attribute of the bridge hides."""
    return frozenset(
        f"{kind}_{snake_case(connection.name)}{half}"
        for connection in connections
        for kind in ("translate", "safe", "goal", "speed")
        for half in ("", f"_{calls.REQUEST}", f"_{calls.RESPONSE}")
    )


@dataclass(frozen=True)
class _Translator:
    """Translates the connections of one bridge."""

    uses: Surroundings
    shared: SharedTranslations
    maps: AlikeMaps
    core: Core

    def call(self, connection: bridge.RosServiceConnection, name: str) -> TranslatedCall:
        """Translates a service connection."""
        request, response = map(self.uses.type_name, calls.types(connection))
        halves = {}
        for half in calls.halves(connection):
            half_connection = calls.as_connection(connection, half)
            own = self.uses.attributes.claim(f"{name}_{half.kind}")
            translated = self.connection(half_connection, own, self.uses.type_name(half.map.type))
            halves[half.kind] = (half_connection, translated)
        return TranslatedCall(name, request, response, halves)

    def connection(self, connection: bridge.Connection, name: str, ros_name: str) -> Translated:
        """Translates a connection."""
        uses, map_ = self.uses, connection.map
        message = uses.view_of(map_.message)
        publishes = is_to_ros(connection)
        joins = _joins(connection, uses)

        parameters = [join.name for join in joins]
        function = f"{snake_case(map_.name)}_to_{'ros' if publishes else 'jaus'}"
        reports = {
            str(join.name): (translated_join.name, uses.view_of(join.message))
            for translated_join in joins
            if isinstance(join := translated_join.join, bridge.ReportJoin)
        }
        types = {
            str(join.name): (translated_join.name, join.type)
            for translated_join in joins
            if isinstance(join := translated_join.join, bridge.Join)
        }
        ends = Ends(
            message, map_.type, {**dict(reports.values()), **dict(types.values())}, publishes
        )

        def make_steps(
            owner: str, view: MessageView, surroundings: Surroundings
        ) -> tuple[Step, ...]:
            if publishes:
                body = to_ros(connection, view, owner, ros_name, reports, surroundings)
            else:
                body = to_jaus(connection, view, owner, types, surroundings)
            return tuple(body.steps)

        print_steps = partial(printed, parameters=parameters)
        compile_steps = partial(self.core.add, function, ends=ends)
        alike = (self.maps.first(map_), publishes, connection.outOfRange.name)
        if any(attribute_map is not map_ for attribute_map in used_maps(map_, to_ros=publishes)):
            # Each connection has its own methods for the messages inside its message.
            steps = make_steps(name, message, uses)
            lines, compiled = print_steps(steps), compile_steps(steps)
        else:
            request = _TranslationRequest(
                name, message, map_, make_steps, print_steps, compile_steps
            )
            lines, compiled = self.shared.translation(alike, request)
        safe_lines: tuple[str, ...] = ()
        # Lists and calls, which are in no model as connections, end in ways of their own.
        if connection.eContainer() is not None and has_stop(connection):
            stopped = stop(connection, message, name, ros_name, uses)
            safe_lines = _returned(printed(stopped.steps))
        return Translated(name, ros_name, joins, lines, safe_lines, alike, compiled)


def _joins(connection: bridge.Connection, uses: Surroundings) -> tuple[TranslatedJoin, ...]:
    """Returns the messages that are joined to the one that a connection takes."""
    scope, map_ = Scope(OWN_NAMES), connection.map
    typed: list[tuple[bridge.Join | bridge.ReportJoin, str]]
    if is_to_ros(connection):
        typed = [(join, uses.view_of(join.message).class_name) for join in map_.reportJoins]
    else:
        typed = [(join, uses.type_name(join.type)) for join in map_.joins]
    return tuple(
        TranslatedJoin(join, scope.claim(snake_case(join.name)), name) for join, name in typed
    )


def _returned(lines: Sequence[str]) -> tuple[str, ...]:
    """Returns statements that set `target` as ones that return it."""
    *before, last = lines
    value = last.removeprefix("target = ")
    return (*lines, "return target") if value == last else (*before, f"return {value}")
