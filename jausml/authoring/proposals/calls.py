"""Connections of ROS services as commands: the JAUS messages, the maps they need, the members."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from jausml.authoring.editing.commands import NEW, Add, Child, Command
from jausml.authoring.proposals.bridging import (
    can_control,
    copied,
    fitting,
    offer_of,
    shifted,
    with_service,
)
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.new_elements import OpenPoint, name_among, open_decisions
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.connections.calls import REQUEST, RESPONSE
from jausml.language.semantics.directions import TO_ROS
from jausml.language.semantics.jaus.commands import (
    is_command,
    is_rejection,
    named,
    obeys_controller_alone,
    responses,
)
from jausml.language.semantics.jaus.fields import attributes
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import find_input, query_name
from jausml.language.semantics.paths.ros_paths import ros_name

_SUCCESS = ("success", "succeeded", "ok", "accepted", "done")
_REASON = ("message", "reason", "error_msg", "error_message", "status_message", "error")
"""Names of members of a response that tell how a call ended, as ROS packages have them."""


@dataclass(frozen=True)
class Call:
    """Calls of a ROS service that a bridge shall carry.

    `service`: name of the ROS service. `to_ros`: whether JAUS components ask, and a node of ROS
    serves.
    """

    service: str
    type: ros.ServiceType
    message: jaus.MessageDef
    to_ros: bool
    answer: jaus.MessageDef | None = None
    rejections: tuple[jaus.MessageDef, ...] = ()

    @property
    def success(self) -> str:
        """The member of the response that tells whether a call succeeded; empty without one."""
        return member_named(self.type.response, _SUCCESS, "bool")

    @property
    def reason(self) -> str:
        """The member of the response that tells why a call failed; empty without one."""
        return member_named(self.type.response, _REASON, "string")


@dataclass(frozen=True)
class Half:
    """A half of calls: the message and the part of the type that a map is to be between.

    `kind`: `request` or `response`. `ready`: a map that is there already.
    """

    kind: str
    message: jaus.MessageDef
    type: ros.MessageType
    to_ros: bool
    ready: bridge.AttributeMap | None


def call_of(
    service: str,
    kind: ros.ServiceType,
    message: jaus.MessageDef,
    *,
    to_ros: bool,
    answer: jaus.MessageDef | None = None,
) -> Call:
    """Returns calls by a message, with the messages with which its service answers it.

    `answer`: the message that answers, None for the one that the service defines.
    """
    owner = message.eContainer()
    if not isinstance(owner, jaus.Service) or message not in owner.inputs:
        raise AnswerError(f"no service takes {name_of(message)}, so nobody asks by it")
    replies = list(responses(message, owner)) if is_command(message) else []
    outputs = [output for ancestor in lineage(owner) for output in ancestor.outputs]
    confirming = [response for response in replies if not is_rejection(response)]
    if answer is None and not is_command(message):
        answer = next(
            (output for output in outputs if query_name(output) == name_of(message)), None
        )
    if answer is None:
        answer = next(iter(confirming), None)
    elif named(name_of(answer), outputs) is None:
        raise AnswerError(f"{name_of(owner)} does not send {name_of(answer)}")
    rejecting = tuple(response for response in replies if is_rejection(response))
    return Call(service, kind, message, to_ros, answer, rejecting)


def halves(scope: Scope, call: Call) -> list[Half]:
    """Returns the halves of calls that need a map, or for which one is ready."""
    optional_halves = [_half(scope, call, REQUEST, call.message, to_ros=call.to_ros)]
    if call.answer is not None:
        optional_halves.append(_half(scope, call, RESPONSE, call.answer, to_ros=not call.to_ros))
    return [half for half in optional_halves if half is not None]


def _half(
    scope: Scope, call: Call, kind: str, message: jaus.MessageDef, *, to_ros: bool
) -> Half | None:
    part: ros.MessageType = getattr(call.type, kind)
    ready = next(iter(fitting(scope, message, part, to_ros=to_ros)), None)
    if ready is None and not _needs_map(call, message, part, to_ros=to_ros):
        return None
    return Half(kind, message, part, to_ros, ready)


def _needs_map(
    call: Call, message: jaus.MessageDef, part: ros.MessageType, *, to_ros: bool
) -> bool:
    """Tells whether a half carries a value, besides the outcome of the call."""
    outcome_members = (call.success, call.reason) if part is call.type.response else ()
    members = [field for field in part.fields if field.name not in outcome_members]
    fields = attributes(message)
    if to_ros:
        return bool(members)
    are_optional = all(getattr(field, "optional", False) for field in fields)
    return bool(fields) and (bool(members) or not are_optional)


def member_named(owner: ros.MessageType, names: Sequence[str], kind: str) -> str:
    """Returns the member of a type that has the first of some names, and is one of a kind."""
    members = members_of(owner, (kind,))
    return next((name for name in names if name in members), "")


def members_of(owner: ros.MessageType, kinds: tuple[str, ...]) -> list[str]:
    """Returns the members of a type with one value, of primitive types that begin as `kinds`."""
    return [
        str(field.name)
        for field in owner.fields
        if isinstance(field, ros.PrimitiveField)
        and str(field.type.name).startswith(kinds)
        and field.arrayKind.name == "single"
    ]


def connection_commands(
    scope: Scope,
    owner: bridge.Bridge,
    call: Call,
    map_commands: Mapping[str, Sequence[Command]],
    name: str,
) -> list[Command]:
    """Returns the commands that make the connection of calls, the service for it and its maps.

    `map_commands`: what makes the maps of halves, by `request` and `response`; the first of each
    makes the map itself.
    """
    offer = offer_of(call.message, to_ros=call.to_ros)
    commands: list[Command] = [] if offer is None else with_service(scope, owner, offer)
    maps_by_part: dict[str, str] = {}
    for half in halves(scope, call):
        if half.kind in map_commands:
            maps_by_part[half.kind] = f"{NEW}{_count(commands)}"
            commands += shifted(map_commands[half.kind], _count(commands))
        elif half.ready is not None:
            maps_by_part[half.kind] = scope.ref(half.ready)
    values: dict[str, tuple[str, ...]] = {"name": (name,)}
    if call.to_ros:
        values["direction"] = (TO_ROS,)
    values |= {"service": (call.service,), "type": (scope.ref(call.type),)}
    values |= {kind: (ref,) for kind, ref in maps_by_part.items()}
    if REQUEST not in maps_by_part:
        values["message"] = (scope.ref(call.message),)
    if RESPONSE not in maps_by_part and call.answer is not None:
        values["answer"] = (scope.ref(call.answer),)
    if call.rejections:
        values["rejections"] = tuple(map(scope.ref, call.rejections))
    peers, search = ({}, ()) if call.to_ros else peers_of(scope, call.message)
    members = {"successMember": call.success, "reasonMember": call.reason}
    values |= peers | {feature: (path,) for feature, path in members.items() if path}
    place = scope.ref(owner)
    inner = (*open_decisions(opens_of(call)), *search)
    return [
        *commands,
        Add(place, "serviceConnections", "bridge.RosServiceConnection", values, inner),
    ]


def peers_of(
    scope: Scope, message: jaus.MessageDef, service: jaus.Service | None = None
) -> tuple[dict[str, tuple[str, ...]], tuple[Child, ...]]:
    """Returns the peers to ask: a component of the model that takes the message, or a search.

    `service`: the service to search for, None for that of the message.
    """
    known = scope.model.instances(jaus.Component, library=False)
    others = (component for component in known if not isinstance(component, bridge.Bridge))
    peer = next((other for other in others if find_input(message, other) is not None), None)
    owner = service or message.eContainer()
    wanted = owner if isinstance(owner, jaus.Service) else None
    values: dict[str, tuple[str, ...]] = {}
    takes_all = wanted is not None and not obeys_controller_alone(message, wanted)
    if is_command(message) and (takes_all or not can_control(peer, wanted)):
        values["control"] = ("false",)
    if peer is not None:
        return {"peers": (scope.ref(peer),), **values}, ()
    return values, (Child("search", "jaus.PeerSearch", {"services": (scope.ref(wanted),)}),)


def own_copy(
    scope: Scope, owner: bridge.Bridge, map_: bridge.AttributeMap
) -> Sequence[Command] | None:
    """Returns the commands that copy a ready map where the model cannot refer to it: XMI to a text.

    Returns none where the model can.
    """
    document = library().document_of(map_)
    if scope.is_text or document is None or document.is_xml:
        return None
    return copied(scope, scope.ref(owner), map_, name_among(name_of(map_), owner.maps))


def _count(commands: Iterable[Command]) -> int:
    return sum(isinstance(command, Add) for command in commands)


def opens_of(call: Call) -> list[OpenPoint]:
    """Returns the decisions about calls that are left to a person, besides those of their maps."""
    open_points = []
    response = ros_name(call.type.response)
    bools = members_of(call.type.response, ("bool",))
    if not call.success and bools:
        text = f"name the bool of {response} that tells whether a call succeeded: "
        text += f"successMember ({', '.join(bools)})"
        open_points.append(OpenPoint(text, "JML473"))
    elif not call.success and not call.to_ros:
        text = f"{response} tells of no failure: a call that fails has no response"
        open_points.append(OpenPoint(text, "JML473"))
    elif not call.success:
        text = f"{response} tells of no failure: each response counts as done"
        open_points.append(OpenPoint(text))
    if call.answer is None and is_command(call.message):
        consequence = "who asks learns of no failure"
        if not call.to_ros:
            consequence = "a call is done when it is sent"
        open_points.append(OpenPoint(f"{name_of(call.message)} has no confirmation: {consequence}"))
    elif (
        call.to_ros and call.answer is not None and not call.rejections and is_command(call.message)
    ):
        text = f"{name_of(call.message)} has no rejection: a call that fails has no answer"
        open_points.append(OpenPoint(text))
    return open_points
