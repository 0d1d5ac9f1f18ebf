"""Rules about connections of ROS services, and about what a bridge answers."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.calls import sent_reports, unanswered
from jausml.language.semantics.connections.limits import LONGEST_TIME, SHORTEST_TIME
from jausml.language.semantics.connections.topics import topic_fault
from jausml.language.semantics.jaus import fields, services
from jausml.language.semantics.jaus.commands import is_emergency, is_steering, told_by_command
from jausml.language.semantics.jaus.core_services import CORE_MESSAGES
from jausml.language.semantics.paths.attributes import PathFault
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import source_paths, spelled_out
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import uncontrollable, unprovided
from jausml.language.validation.rule import Finding, Note, rule

_ENDS = (
    *("name", "direction", "type", "request", "response", "message", "answer", "rejections"),
    *("peers", "search", "control"),
)
_CORE_CODES = frozenset(CORE_MESSAGES.values())


def _is_sound(subject: Subject, connection: bridge.RosServiceConnection) -> bool:
    return (
        connection.eContainer() is not None
        and subject.is_intact(connection.type, *calls.messages(connection))
        and all(
            subject.is_intact(half.map.type, half.map.message) for half in calls.halves(connection)
        )
    )


def _fits(subject: Subject, connection: bridge.RosServiceConnection) -> bool:
    """Tells whether the maps are those of request and response, so that messages are as meant."""
    if not _is_sound(subject, connection):
        return False
    parts = dict(zip((calls.REQUEST, calls.RESPONSE), calls.types(connection), strict=True))
    return all(half.map.type is parts[half.kind] for half in calls.halves(connection))


_of_calls = partial(rule, kinds=bridge.RosServiceConnection, needs=_ENDS, condition=_is_sound)


@_of_calls("JML467", "map that does not fit the service", is_decision=True)
def maps_fit(subject: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """The maps of a service connection are those of the request and the response of its type.

    The map of a message that the bridge makes has assignments for that direction: from ROS to JAUS
    for the request of a served service, and from JAUS to ROS for its response; the other way for a
    service that is called. `message` and `answer` do not repeat what a map states.

    Bad: `request="lamp_read"` with a map for `std_srvs/Trigger.response`

    Good: `response="lamp_read"`
    """
    parts = dict(zip((calls.REQUEST, calls.RESPONSE), calls.types(connection), strict=True))
    for half in calls.halves(connection):
        map_, part = half.map, parts[half.kind]
        if map_.type is not part:
            text = f"map '{map_.name}' is for {ros_name(map_.type)}, not for the {half.kind}"
            note = Note(map_, f"map '{map_.name}'", "type")
            message = f"{text} of {ros_name(connection.type)}"
            yield Finding(connection, message, half.kind, related=(note,))
            continue
        feature = "toRos" if half.to_ros else "toJaus"
        targets = map_.type.fields if half.to_ros else fields.attributes(map_.message)
        if targets and not getattr(map_, feature) and subject.is_intact(map_):
            message = f"map '{map_.name}' has no {feature} assignments, which its place needs"
            note = Note(map_, f"map '{map_.name}'")
            yield Finding(connection, message, half.kind, related=(note,))
    for of_map, of_message in ((calls.REQUEST, "message"), (calls.RESPONSE, "answer")):
        if getattr(connection, of_map) is not None and getattr(connection, of_message):
            message = f"'{connection.name}' states '{of_message}', which its {of_map} map has"
            yield Finding(connection, message, of_message, "leave it out")


@_of_calls("JML468", "service without a message that asks")
def something_asks(_: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """A service connection names the message that asks: by a map of the request or by `message`.

    Bad: a service connection with `type` and `peers` alone

    Good: the same with `message`, such as a query
    """
    if calls.asking(connection) is None:
        message = f"'{connection.name}' has no JAUS message that asks"
        yield Finding(connection, message, None, "state a map for 'request', or a 'message'")


@rule(
    "JML469",
    "no service for the messages of a call",
    kinds=bridge.RosServiceConnection,
    needs=_ENDS,
    condition=_fits,
)
def messages_provided(
    subject: Subject, connection: bridge.RosServiceConnection
) -> Iterator[Finding]:
    """The component that is asked provides a service that takes the question and answers it.

    That is each peer, where the bridge serves a ROS service, and the bridge itself, where it calls
    one. Inherited services count, and so does the same message in another service. The runtime
    itself answers the messages of core services that come to a bridge; it tells a connection of
    SetEmergency or ClearEmergency when an emergency of the bridge has begun or ended.

    Bad: `peers="sensor"` with SetEmergency, where sensor has `coreServices="none"`

    Good: the same with a peer that provides Management
    """
    for provider in _asked(connection):
        if services.is_known(subject, provider):
            yield from _provided(connection, provider)
    asking = calls.asking(connection)
    if calls.serves(connection) or asking is None or is_emergency(asking):
        return
    if services.code(asking) in _CORE_CODES:
        message = f"the runtime itself takes {asking.name} of '{connection.name}'"
        yield Finding(connection, message, _feature(connection, asking), "take another message")


@_of_calls("JML470", "service without a peer")
def peers_named(_: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """A bridge that serves a ROS service names the peers that it asks, or searches for them.

    Bad: a service connection without `peers`

    Good: the same with `peers="vehicle"`
    """
    if calls.serves(connection) and not connection.peers and connection.search is None:
        message = f"'{connection.name}' names no peer to ask"
        yield Finding(connection, message, "peers", "name peers or search for them")


@_of_calls("JML471", "call of a peer that cannot be controlled")
def peers_controllable(
    subject: Subject, connection: bridge.RosServiceConnection
) -> Iterator[Finding]:
    """A service connection that controls its peers has peers that provide AccessControl.

    Commands wait until control is granted, which such a peer never does (AS5710).

    Bad: `control` (true by default) for a command to a peer without AccessControl

    Good: `control="false"` for this peer
    """
    asking = calls.asking(connection)
    is_sent = asking is not None and is_steering(asking) and calls.serves(connection)
    if not is_sent or not connection.control:
        return
    yield from uncontrollable(subject, connection, services.peers_of(connection))


@rule(
    "JML472",
    "member that tells of no failure",
    kinds=bridge.RosServiceConnection,
    needs=("name", "type", "successMember", "reasonMember"),
)
def members_tell(subject: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """The members that say whether a call succeeded, and why not, are a bool and a string.

    They are members of the response.

    Bad: `successMember="message"`, a string, with std_srvs/SetBool

    Good: `successMember="success" reasonMember="message"`
    """
    if connection.type is None or not subject.is_intact(connection.type):
        return
    for feature, kind in (("successMember", "bool"), ("reasonMember", "string")):
        path = getattr(connection, feature)
        fault = _member_fault(connection.type.response, path, kind) if path else None
        if fault is not None:
            yield Finding(connection, fault.message, feature, fault.hint)


@rule(
    "JML473",
    "failures that cannot be told",
    severity=Severity.WARNING,
    is_decision=True,
    kinds=bridge.RosServiceConnection,
    needs=("name", "type", "direction", "response", "successMember"),
)
def failures_told(subject: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """The connection of a service says which member of the response tells whether a call succeeded.

    Otherwise a call of a served service that fails gets no response, and its client waits until it
    gives up: a made-up response would report success. A service that is called may answer that it
    failed: where its response has a bool that no map reads, and nothing says what that means, each
    response counts as success, and JAUS is told that all went well.

    Bad: `type` std_srvs/Trigger without `successMember`

    Good: the same with `successMember="success"`
    """
    if connection.successMember:
        return
    if calls.serves(connection):
        message = f"clients of '{connection.name}' get no response when a call comes to nothing"
        yield Finding(connection, message, "type", "name a bool of the response: successMember")
    elif bools := _untaken_bools(subject, connection):
        message = f"a call of '{connection.name}' that fails counts as done"
        hint = f"successMember names the bool that tells it, such as {' or '.join(bools)}"
        yield Finding(connection, message, "type", hint)


def _untaken_bools(subject: Subject, connection: bridge.RosServiceConnection) -> list[str]:
    """Returns the bools of a response that no map reads."""
    if connection.type is None or not subject.is_intact(connection.type):
        return []
    map_ = connection.response
    if map_ is not None and not subject.is_intact(map_):
        return []
    assignments = spelled_out(map_, to_ros=False) if map_ else ()
    read = {path for assignment in assignments for path in source_paths(assignment)}
    return [
        str(field.name)
        for field in connection.type.response.fields
        if isinstance(field, ros.PrimitiveField)
        and field.type.name == "bool"
        and field.arrayKind.name == "single"
        and field.name not in read
    ]


@rule(
    "JML474",
    "timeout of calls out of range",
    kinds=bridge.RosServiceConnection,
    needs=("name", "timeout"),
)
def timeouts(_: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """The timeout of a service connection is above 0, and at most an hour.

    Bad: `timeout="0"`

    Good: `timeout="2.5"`
    """
    seconds = connection.timeout
    if not SHORTEST_TIME <= seconds <= LONGEST_TIME:
        allowed = f"{SHORTEST_TIME:g}..{LONGEST_TIME:g} s"
        message = f"timeout {seconds:g} of '{connection.name}' is not in {allowed}"
        yield Finding(connection, message, "timeout")


@rule(
    "JML476",
    "illegal name of a ROS service",
    kinds=bridge.RosServiceConnection,
    needs=("name", "service"),
)
def names(_: Subject, connection: bridge.RosServiceConnection) -> Iterator[Finding]:
    """The name of a ROS service has letters, digits, `_` and `/`, and does not begin with a digit.

    Bad: `service="switch lamp"`

    Good: `service="switch_lamp"`
    """
    fault = topic_fault(connection.service or "")
    if fault:
        message = f"service name {connection.service!r} of '{connection.name}' {fault}"
        yield Finding(connection, message, "service")


def _asked(connection: bridge.RosServiceConnection) -> list[services.Provider]:
    """Returns the providers that are asked: the peers, or the bridge itself."""
    owner = connection.eContainer()
    if not calls.serves(connection):
        return [] if owner is None else [owner]
    return services.peers_of(connection)


def _provided(
    connection: bridge.RosServiceConnection, provider: services.Provider
) -> Iterator[Finding]:
    asking = calls.asking(connection)
    answers = [message for message in calls.messages(connection) if message is not asking]
    if asking is not None and services.find_input(asking, provider) is None:
        feature = _feature(connection, asking)
        yield unprovided(connection, provider, asking, "takes", feature)
    for answer in answers:
        if services.find_output(answer, provider) is None:
            yield unprovided(connection, provider, answer, "sends", _feature(connection, answer))


def _feature(connection: bridge.RosServiceConnection, message: jaus.MessageDef) -> str:
    """Returns the feature by which a service connection has a message."""
    if message is calls.asking(connection):
        return "message" if connection.request is None else calls.REQUEST
    if message is calls.answering(connection):
        return "answer" if connection.response is None else calls.RESPONSE
    return "rejections"


def _member_fault(response: ros.MessageType, path: str, kind: str) -> PathFault | None:
    """Returns why a path leads to no single value of a kind, None when it does."""
    place = calls.member(response, path)
    if place is None or isinstance(place, PathFault):
        return place
    field = place.field
    is_one = isinstance(field, ros.PrimitiveField) and not place.is_array
    if is_one and isinstance(field, ros.PrimitiveField) and field.type.name == kind:
        return None
    return PathFault(f"'{path}' of {ros_name(response)} is no {kind}")


@rule("JML367", "query that nothing answers", severity=Severity.INFO, kinds=bridge.Bridge)
def answers_queries(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """A bridge answers the queries of the services that it provides.

    Discovery announces the whole service. Who asks what no connection answers waits in vain, and
    may take the bridge for dead. The runtime answers the core services, a list driver tells its
    speed and its active element, and a connection of commands tells the last one that it passed
    on. What is left needs a connection to JAUS with the report, or an answer in the code of the
    bridge, which no rule sees: so this is no warning.

    Bad: a bridge that provides VelocityStateSensor, with no connection for ReportVelocityState

    Good: with a connection to JAUS for ReportVelocityState
    """
    if not services.is_known(subject, owner) or not _is_read(subject, owner):
        return
    sent = sent_reports(owner) | set(_meant(owner))
    for service in owner.provides:
        if queries := unanswered(service, sent):
            names = ", ".join(str(query.name) for query in queries)
            message = f"no connection of '{owner.name}' answers {names} of {service.name}"
            hint = "add a connection to JAUS with the report, or answer in its code"
            yield Finding(owner, message, "provides", hint)


def _meant(owner: bridge.Bridge) -> Iterator[int]:
    """Yields the codes of reports that connections without another end would send the right way.

    One that goes the wrong way has a finding of its own.
    """
    for connection in owner.bridgeConnections:
        if not (connection.peers or connection.search):
            message = connection.map.message
            answer = told_by_command(message, owner.provides)
            yield services.code(message if answer is None else answer.report)


def _is_read(subject: Subject, owner: bridge.Bridge) -> bool:
    """Whether all that the bridge may send is known."""
    carried = [bridge_connection.map for bridge_connection in owner.bridgeConnections]
    elements = [action_connection.element for action_connection in owner.actionConnections]
    drivers = [action_connection.driver for action_connection in owner.actionConnections]
    messages = [element.message for element in (*carried, *elements) if element is not None]
    return subject.is_intact(*carried, *elements, *drivers, *messages, *owner.serviceConnections)
