"""Commands and queries: whom a component obeys (AS5710, AccessControl), and what answers them.

Whoever provides a service answers its queries (AS5684). A command that a bridge has obeyed answers
the query for it, as its report is laid out in the same way.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from jausml.language.attributes.guards import GuardError, alternatives, parse_guard
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.core_services import CORE, is_core_message, standard_services
from jausml.language.semantics.jaus.fields import attributes
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import states_of
from jausml.language.semantics.jaus.services import (
    code,
    inputs_by_name,
    outputs_by_name,
    provided_services,
    query_name,
    same_code,
    searched_services,
    signature,
)
from jausml.language.semantics.subject import remembered
from jausml.language.wire.kinds import PRESENCE_VECTOR

Guard = Literal["ANY", "CONTROLLED", "READY"]

# Set in Standby too (AS6009, protocol behaviour of the waypoint, list and velocity drivers).
_STANDBY_MESSAGES = frozenset(
    ["SetGlobalWaypoint", "SetLocalWaypoint", "SetElement", "DeleteElement", "SetAccelerationLimit"]
)
_WITHOUT_CONTROL = frozenset(["ClearEmergency", "ReleaseControl", "RequestControl", "SetEmergency"])
_EMERGENCIES = frozenset(["SetEmergency", "ClearEmergency"])
_FIRST_QUERY = 0x2000
_OF_STANDARDS = "urn:jaus:jss:"
_ACCESS_CONTROL = f"{CORE}AccessControl"
_MANAGEMENT = f"{CORE}Management"


def is_command(message: jaus.MessageDef) -> bool:
    """Tells whether a message commands its receiver.

    Inputs with a code below 2000h do, whether it is said or not: the JSIDL of ExecuteList forgets
    to. Outputs with such a code are answers, e.g. ConfirmControl.
    """
    owner = message.eContainer()
    is_of_class = 0 <= code(message) < _FIRST_QUERY
    return message.isCommand or (is_of_class and owner is not None and message in owner.inputs)


def is_emergency(message: jaus.MessageDef) -> bool:
    """Tells whether a message sets or ends an emergency of a component (AS5710, Management).

    The runtime obeys it, from anybody and in any state. A connection carries what becomes of it:
    that the emergency of the bridge has begun, or has ended.
    """
    return message.name in _EMERGENCIES and is_core_message(message)


def is_steering(message: jaus.MessageDef) -> bool:
    """Tells whether a message is a command of the controller: not of an emergency."""
    return is_command(message) and not is_emergency(message)


def is_published(message: jaus.MessageDef) -> bool:
    """Tells whether a message belongs to a service of a standard."""
    owner = message.eContainer()
    return owner is not None and str(getattr(owner, "urn", "")).startswith(_OF_STANDARDS)


def needs_control(message: jaus.MessageDef, service: jaus.Service) -> bool:
    """Tells whether a component obeys a message from its controller alone.

    So it does with the commands of services that inherit AccessControl, as the standards say.
    Published services without it have commands for everyone, e.g. RegisterServices; the author of
    another service did not ask for that by leaving the inheritance out.
    """
    is_published = str(service.urn).startswith(_OF_STANDARDS)
    return is_command(message) and (not is_published or _has(_ACCESS_CONTROL, lineage(service)))


def obeys_controller_alone(message: jaus.MessageDef, service: jaus.Service) -> bool:
    """Tells whether control has to be had before a message is sent.

    Control itself is requested without, and an emergency anybody may set.
    """
    return needs_control(message, service) and message.name not in _WITHOUT_CONTROL


def needs_ready(service: jaus.Service, provided: Iterable[jaus.Service]) -> bool:
    """Tells whether a component obeys the commands of a service in Ready alone.

    Args:
        service: The service that takes them. One that inherits no AccessControl shares the states
            of the component.
    """
    own = lineage(service)
    return _has(_MANAGEMENT, own if _has(_ACCESS_CONTROL, own) else provided)


CONTROLLER = "isControllingClient"
"""Condition of guards that holds for the controller of a component alone."""

_NO_COMMANDS = ("Query", "Report", "Confirm", "Reject", "Event")


def controlled_by_nobody(service: jaus.Service) -> list[jaus.MessageDef]:
    """Returns the inputs of an own service that anybody may send, though others need control.

    Whoever sends a query or a report commands nothing, nor who sends what guards let pass from the
    controller alone.
    """
    is_published = str(service.urn).startswith(_OF_STANDARDS)
    if is_published or not any(needs_control(message, service) for message in service.inputs):
        return []
    suspects = [
        message
        for message in service.inputs
        if not is_command(message)
        and not str(message.name).startswith(_NO_COMMANDS)
        and not _is_guarded(message, service)
    ]
    # Most services have none, and need not look through all that they inherit.
    if not suspects:
        return []
    query_names = {
        query_name(message) for ancestor in lineage(service) for message in ancestor.outputs
    }
    return [message for message in suspects if message.name not in query_names]


def _is_guarded(message: jaus.MessageDef, service: jaus.Service) -> bool:
    guards = [transition.guard for transition in _taking(message, service)]
    return bool(guards) and all(map(asks_for_controller, guards))


def asks_for_controller(text: str | None) -> bool:
    """Tells whether a guard depends on the controller in each of its alternatives.

    `isControllingClient || isWarm` does not: when it is warm, every component is obeyed. What is no
    guard, or has too many alternatives, is assumed to ask.
    """
    try:
        guard = parse_guard(text)
    except GuardError:
        return True
    choices = [()] if guard is None else alternatives(guard)
    return choices is None or all(
        any(condition.name == CONTROLLER for condition, _ in choice) for choice in choices
    )


def guard_of(
    message: jaus.MessageDef, service: jaus.Service, provided: Iterable[jaus.Service]
) -> Guard:
    """Returns whom a component obeys an input message from."""
    if not needs_control(message, service):
        return "ANY"
    is_for_ready = message.name not in _STANDBY_MESSAGES and needs_ready(service, provided)
    return "READY" if is_for_ready else "CONTROLLED"


def guard_of_receivers(
    message: jaus.MessageDef,
    receivers: Iterable[jaus.Component | None],
    search: jaus.PeerSearch | None,
) -> Guard:
    """Returns whom the receivers of a message obey, be they named or searched for."""
    service = message.eContainer()
    if service is None or is_emergency(message) or not needs_control(message, service):
        return "ANY"
    # A command that a service keeps in Standby moves what listens to a topic at once.
    provided = _provided_by(receivers, search)
    is_for_ready = all(needs_ready(service, service_list) for service_list in provided or [[]])
    return "READY" if is_for_ready else "CONTROLLED"


def guard_of_executors(peers: Iterable[jaus.Component], search: jaus.PeerSearch | None) -> Guard:
    """Returns in which state peers execute lists or missions: in Ready, where they have states.

    A mission spooler inherits no Management, but its component may have it for others.
    """
    has_states = all(_has(_MANAGEMENT, service) for service in _provided_by(peers, search))
    return "READY" if has_states else "CONTROLLED"


def _provided_by(
    receivers: Iterable[jaus.Component | None], search: jaus.PeerSearch | None
) -> list[list[jaus.Service]]:
    if search is not None:
        # What is found mostly is as components are that name nothing.
        return [[*searched_services(search), *standard_services()]]
    return [provided_services(receiver) for receiver in receivers if receiver is not None]


def _has(urn: str, services: Iterable[jaus.Service]) -> bool:
    return any(service.urn == urn for service in services)


@dataclass(frozen=True)
class Answer:
    """A query that is answered, and how."""

    query: jaus.MessageDef
    report: jaus.MessageDef


def answer_by(service: jaus.Service, report: jaus.MessageDef | None) -> Answer | None:
    """Returns the answer with a report of a service; None without a query for it."""
    if report is None:
        return None
    query = _of_lineage(service, inputs_by_name, query_name(report))
    return None if query is None else Answer(query, report)


def answer_alike(service: jaus.Service, message: jaus.MessageDef) -> Answer | None:
    """Returns the answer with the fields of a message that set them; None without one.

    The report is laid out as the message is, so that nothing has to be translated.
    """
    wanted = f"Report{(message.name or '').removeprefix('Set')}"
    report = _of_lineage(service, outputs_by_name, wanted)
    is_alike = report is not None and signature(report) == signature(message)
    return answer_by(service, report) if is_alike else None


def _of_lineage(
    service: jaus.Service,
    by_name: Callable[[jaus.Service], Mapping[str, jaus.MessageDef]],
    name: str,
) -> jaus.MessageDef | None:
    """Returns the first message of a name in a service and its inherited ones."""
    messages = (by_name(ancestor).get(name) for ancestor in lineage(service))
    return next((message for message in messages if message is not None), None)


def named(name: str, messages: Iterable[jaus.MessageDef]) -> jaus.MessageDef | None:
    """Returns the first message of a name."""
    return next((message for message in messages if message.name == name), None)


def chosen_fields(answer: Answer) -> list[str] | None:
    """Returns the fields of a query that choose the report, besides its contents.

    QueryVelocityCommand, for example, names the type of the command.

    Returns:
        The names of plain fields of both; None when the query says it in another way.
    """
    asked = [
        attribute for attribute in attributes(answer.query) if attribute.name != PRESENCE_VECTOR
    ]
    reported_names = {
        attribute.name
        for attribute in attributes(answer.report)
        if isinstance(attribute, jaus.FixedField)
    }
    if all(isinstance(field, jaus.FixedField) and field.name in reported_names for field in asked):
        return [str(field.name) for field in asked]
    return None


def told_by_command(message: jaus.MessageDef, services: Iterable[jaus.Service]) -> Answer | None:
    """Returns the answer with the last command that a component obeys; None without one.

    It can be of what moves something: of a SetLocalPose nobody knows whether it still holds.
    """
    if not (is_command(message) and message.moves):
        return None
    for service in services:
        answer = answer_alike(service, message)
        if answer is not None and chosen_fields(answer) is not None:
            return answer
    return None


def command_answer(connection: bridge.Connection) -> Answer | None:
    """Returns the answer with the command that a connection carries to ROS; None without one."""
    owner, taken = connection.eContainer(), _taken(connection)
    # Of several for one command, for several peers, none knows which came last.
    if owner is None or taken is None or _times_taken(owner)[code(taken)] > 1:
        return None
    return told_by_command(taken, owner.provides)


@remembered
def _times_taken(owner: bridge.Bridge) -> Counter[int]:
    """Returns by code how many connections of a bridge take a message from JAUS.

    On the wire it is its code alone: several services have a SetTravelSpeed.
    """
    messages = map(_taken, owner.bridgeConnections)
    return Counter(code(message) for message in messages if message is not None)


def _taken(connection: bridge.Connection) -> jaus.MessageDef | None:
    """Returns the message that a connection takes from JAUS as it comes."""
    is_taken = is_to_ros(connection) and connection.exchange.name == "message"
    return connection.map.message if is_taken and connection.map is not None else None


_REJECTING = "Reject"
_ANSWERING = ("Confirm", _REJECTING)


def responses(message: jaus.MessageDef, service: jaus.Service) -> list[jaus.MessageDef]:
    """Returns the messages with which the provider of a service answers a command.

    Its machine says them. Most services of the standards have none here: then those that confirm or
    reject what the command is named after, as ConfirmElementRequest does for SetElement.
    """
    messages = dict.fromkeys(_sent_by_machine(message, service))
    return list(messages) or [
        output
        for output in service.outputs
        if (topic := _topic(output)) and topic in str(message.name)
    ]


def is_rejection(message: jaus.MessageDef) -> bool:
    """Tells whether an answer rejects the request."""
    return str(message.name).startswith(_REJECTING)


def told_after(message: jaus.MessageDef, service: jaus.Service) -> Answer | None:
    """Returns the query and the report that tell what a command has set; None without any.

    The commands of Management set the state of a component, SetX what QueryX asks for.
    """
    topic = "Status" if service.urn == _MANAGEMENT else str(message.name).removeprefix("Set")
    report = _of_lineage(service, outputs_by_name, f"Report{topic}")
    return answer_by(service, report)


def _sent_by_machine(message: jaus.MessageDef, service: jaus.Service) -> Iterator[jaus.MessageDef]:
    for transition in _taking(message, service):
        yield from (done.sends for done in transition.actions if done.sends is not None)


def _taking(message: jaus.MessageDef, service: jaus.Service) -> Iterator[jaus.Transition]:
    """Yields the transitions of the machines of a service that a message triggers."""
    for machine in service.machines:
        for _, state in states_of(machine):
            for transition in (*state.transitions, *state.defaults):
                if transition.message is not None and same_code(transition.message, message):
                    yield transition


def _topic(answer: jaus.MessageDef) -> str:
    """Returns the request that an answer confirms or rejects, by its name; empty for neither."""
    name = str(answer.name)
    verb = next((prefix for prefix in _ANSWERING if name.startswith(prefix)), None)
    return "" if verb is None else name.removeprefix(verb).removesuffix("Request")
