"""Views of connections of ROS services and actions, for the templates of a bridge package.

An element of the list of an action is translated as the message of a connection is; so it stands
among the connections, with a translation, tests and parameters of its own.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field

from jausml.generation.errors import GenerationError
from jausml.generation.literals import docstring, printable, python_literal, python_string
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.calls import (
    DriverMessages,
    answers,
    driver_messages,
    knows_speed,
    speed_answer,
)
from jausml.language.semantics.connections.reports import requested_in
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import (
    Answer,
    answer_alike,
    guard_of_executors,
    guard_of_receivers,
    is_steering,
)
from jausml.language.semantics.jaus.services import code
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.ends import peers_of, priority_of, query_call
from jausml_generators.bridge.translation.translating import TranslatedCall
from jausml_generators.common.ros import ros_type
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Blob, Fixed
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import call, condition, tuple_of


def carried(owner: bridge.Bridge) -> list[bridge.Connection]:
    """Returns the connections and elements of lists for which translations are generated."""
    return [*owner.bridgeConnections, *map(calls.of_elements, owner.actionConnections)]


def messages_of_driver(action: bridge.RosActionConnection) -> DriverMessages:
    """Returns the messages of the list driver of a connection.

    Raises:
        GenerationError: The service is no list driver.
    """
    messages = driver_messages(action.driver)
    if messages is None:
        raise GenerationError(f"connection '{action.name}': {action.driver.name} drives no list")
    return messages


def answers_of_driver(action: bridge.RosActionConnection) -> list[Answer]:
    """Returns the answers of a connection's list driver; connections of the bridge come first."""
    owner = action.eContainer()
    others = owner.bridgeConnections if isinstance(owner, bridge.Bridge) else ()
    asked = (other for other in others if other.exchange.name != "message")
    taken = {code(connection.map.message) for connection in asked if not is_to_ros(connection)}
    return [answer for answer in answers(action) if code(answer.report) not in taken]


@dataclass(frozen=True)
class ActionView(ConnectionView):
    """A modelled action connection; inherited members are about its elements."""

    action: bridge.RosActionConnection = field(kw_only=True)

    @property
    def owner(self) -> bridge.Bridge | None:
        """The bridge in the model."""
        return self.action.eContainer()

    @property
    def kind(self) -> str:
        """Class of the runtime that carries it."""
        return "ListToAction" if self.to_ros else "ActionToList"

    @property
    def summary(self) -> str:
        """The source and target of an element."""
        return f"{super().summary}, an element of {printable(self.action.action)}"

    @functools.cached_property
    def driver(self) -> DriverMessages:
        """ExecuteList, QueryActiveElement and ReportActiveElement, or those of missions."""
        return messages_of_driver(self.action)

    @property
    def query_element(self) -> jaus.MessageDef | None:
        """No report is asked for by itself."""
        return None

    @property
    def _bound(self) -> bridge.RosActionConnection:
        return self.action

    @property
    def rate(self) -> float | None:
        """Lists come when they come."""
        return None

    @property
    def is_command(self) -> bool:
        """Whether it moves the vehicle."""
        return True

    @property
    def has_safe_value(self) -> bool:
        """The runtime stops lists by itself."""
        return False

    @property
    def argument_lines(self) -> tuple[str, ...]:
        """Arguments of the runtime class after name and translate."""
        action = self.action
        lines = [f"message={self.message_name}"] if self.to_ros else []
        lines += [f"action={self._action}", f"driver={self._driver}"]
        if self.to_ros:
            lines += [*self._answers, f"fill=self.{self.hook}"]
        else:
            lines += [f"speed={python_literal(self.speed)}", f"speed_of=self.{self.hook}"]
            if self._guard != "READY":
                lines.append(f"control=Guard.{self._guard}")
            if action.onEnd.name == "pause":
                lines.append("pauses=True")
        if self.action.peers or self.action.search is not None or not self.to_ros:
            lines.append(f"peers={self.peers}")
        return (*lines, f"timeout={python_literal(float(action.timeout))}")

    @property
    def _guard(self) -> str:
        """Whom peers obey that are to execute something."""
        action = self.action
        if not action.control:
            return "ANY"
        return guard_of_executors(action.peers, action.search)

    @property
    def speed(self) -> float:
        """Metres per second at which lists are executed."""
        return float(self.action.speed)

    @property
    def _driver(self) -> str:
        of_one = "WaypointMessages" if self.driver.is_single else "ListMessages"
        kind = "MissionMessages" if self.driver.spooler else of_one
        return call(kind, *(self.view_of(message).class_name for message in self.driver.all))

    @property
    def _answers(self) -> list[str]:
        """The answers of the driver besides the active element, unless a connection has them."""
        action = self.action
        list_answers = {
            "speed": speed_answer(action.driver),
            "element": answer_alike(action.driver, action.element.message),
        }
        free = answers_of_driver(action)
        arguments = [
            f"{name}={self._pair(answer)}"
            for name, answer in list_answers.items()
            if answer in free
        ]
        return [f"answers={call('ListAnswers', *arguments)}"] if arguments else []

    def _pair(self, answer: Answer) -> str:
        return tuple_of(
            *(self.view_of(message).class_name for message in (answer.query, answer.report))
        )

    @property
    def _action(self) -> str:
        action = self.action
        arguments = [
            python_string(ros_type(action.type).full_name),
            python_string(action.action),
            self.ros_name,
            python_string(action.goalMember),
        ]
        if action.progressMember:
            arguments.append(f"progress={python_string(action.progressMember)}")
        if action.progress.name != "index":
            arguments.append(f"counting=Progress.{action.progress.name.upper()}")
        if action.reasonMember:
            arguments.append(f"reason={python_string(action.reasonMember)}")
        return call("ListAction", *arguments)

    # ------------------------------------------------------------------ the hook

    @property
    def hook(self) -> str:
        """Name of the method that users may override for members of a goal besides its list."""
        return f"{'goal' if self.to_ros else 'speed'}_{self.name}"

    @property
    def hook_parameters(self) -> tuple[str, ...]:
        """Parameters of that method, without their types."""
        return ("goal", "speed") if self.to_ros else ("goal",)

    @property
    def hook_signature(self) -> str:
        """First line of that method."""
        if self.to_ros:
            return f"def {self.hook}(self, goal: Any, speed: float | None) -> None:"
        return f"def {self.hook}(self, goal: Any) -> float:"

    @property
    def hook_lines(self) -> tuple[str, ...]:
        """Statements of that method, as it is generated."""
        if self.to_ros:
            return ("del goal, speed  # for those who override it",)
        return ("del goal  # for those who override it", f"return self.{self.name}.speed")

    @property
    def hook_documentation(self) -> str:
        """The documentation of that method."""
        kind = ros_type(self.action.type).full_name
        if not self.to_ros:
            return f"Returns the speed in m/s at which the list of a goal of {kind} is executed."
        spoken = knows_speed(self.driver)
        speed = "is in m/s, as ExecuteList says it" if spoken else "is None: this driver knows none"
        member = printable(self.action.goalMember)
        return f"Sets what a goal of {kind} has besides {member}.\n\nThe speed {speed}."

    @property
    def hook_stub(self) -> str:
        """The stub of that method for the skeleton."""
        about = docstring(self.hook_documentation, 8)
        body = f"return super().{self.hook}({', '.join(self.hook_parameters)})"
        return f"    {self.hook_signature}\n        {about}\n        {body}\n"


@dataclass(frozen=True)
class CallView:
    """A modelled service connection."""

    connection: bridge.RosServiceConnection
    translated: TranslatedCall
    view_of: Callable[[jaus.MessageDef], MessageView]

    @property
    def name(self) -> str:
        """Its name in Python."""
        return self.translated.name

    @property
    def model_name(self) -> str:
        """Its name in the model, also in diagnostics, parameters and logs."""
        return str(self.connection.name)

    @property
    def kind(self) -> str:
        """Class of the runtime that carries it."""
        return "RosServiceToJaus" if calls.serves(self.connection) else "JausToRosService"

    @functools.cached_property
    def halves(self) -> dict[str, ConnectionView]:
        """The halves that maps translate, as connections."""
        return {
            kind: ConnectionView(connection, translated, self.view_of)
            for kind, (connection, translated) in self.translated.halves.items()
        }

    @property
    def service_arguments(self) -> tuple[str, ...]:
        """Arguments of RosService."""
        connection = self.connection
        request = ros_type(connection.type.request)
        arguments = [
            python_string(connection.service),
            python_string(f"{request.package}/srv/{connection.type.name}"),
            self.translated.request_name,
            self.translated.response_name,
        ]
        members = {"success": connection.successMember, "reason": connection.reasonMember}
        arguments += [
            f"{key}={python_string(_path(path))}" for key, path in members.items() if path
        ]
        return tuple(arguments)

    @property
    def argument_lines(self) -> tuple[str, ...]:
        """Arguments of the runtime class after the name."""
        connection = self.connection
        arguments = [
            ("service", call("RosService", *self.service_arguments)),
            ("request", self._request),
            ("response", self._half(calls.RESPONSE, calls.answering(connection))),
            ("peers", peers_of(connection)),
        ]
        if connection.rejections:
            names = ", ".join(
                self.view_of(rejection).class_name for rejection in connection.rejections
            )
            arguments.append(("rejections", f"[{names}]"))
            arguments += self._reason
        arguments += self._guarding
        arguments += priority_of(connection)
        arguments.append(("timeout", python_literal(float(connection.timeout))))
        return tuple(f"{key}={value}" for key, value in arguments)

    @property
    def _reason(self) -> list[tuple[str, str]]:
        """Argument for the only text of the rejection that is sent, which says why."""
        if calls.serves(self.connection):
            return []
        members = self.view_of(self.connection.rejections[0]).body.members
        sizes = {
            member.attribute: value.upper if isinstance(value, Blob) else value.size
            for member in members
            if isinstance(value := member.value, Fixed | Blob) and value.python_type == "str"
        }
        if len(sizes) != 1:
            return []
        ((name, size),) = sizes.items()
        return [("reason", tuple_of(python_string(name), str(size)))]

    @property
    def _guarding(self) -> list[tuple[str, str]]:
        """Arguments that say whom to obey, or what of others is controlled."""
        connection, message = self.connection, calls.asking(self.connection)
        if message is None:
            return []
        arguments = []
        if is_steering(message):
            arguments.append(("is_command", "True"))
        if calls.serves(connection):
            guard = guard_of_receivers(message, connection.peers, connection.search)
            if guard != "ANY" and connection.control:
                arguments.append(("control", f"Guard.{guard}"))
            if calls.maps_success(connection):
                arguments.append(("is_success_mapped", "True"))
        else:
            guard = guard_of_receivers(message, [connection.eContainer()], None)
            if guard != "ANY":
                arguments.append(("when", condition(message, guard)))
        return arguments

    @property
    def _request(self) -> str:
        """The request: a translation, the message that is sent, or the class of what is taken."""
        message = calls.asking(self.connection)
        if calls.REQUEST in self.halves or message is None or not calls.serves(self.connection):
            return self._half(calls.REQUEST, message)
        view = self.view_of(message)
        answer = self.halves.get(calls.RESPONSE)
        read = requested_in(self.connection.response)
        return query_call(view, answer.message if answer is not None else None, read)

    def _half(self, kind: str, message: jaus.MessageDef | None) -> str:
        if kind in self.halves:
            return f"self.{self.halves[kind].name}"
        return "None" if message is None else self.view_of(message).class_name


def _path(path: str) -> str:
    """Returns the path of a member of a response in Python."""
    return ".".join(map(snake_case, path.split(".")))
