"""View of one service connection, for the templates of a bridge package."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import python_literal, python_string
from jausml.language.semantics.connections import calls
from jausml.language.semantics.connections.reports import requested_in
from jausml.language.semantics.jaus.commands import guard_of_receivers, is_command
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.jaus_ends import peers_of, priority_of, query_call
from jausml_generators.common.ros import ros_type
from jausml_generators.python.guards import condition
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.language.metamodel.classes import bridge, jaus
    from jausml_generators.bridge.translation.translating import TranslatedCall
    from jausml_generators.python.codec.messages import MessageView


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
        """Its name in the model, by which diagnostics, parameters and logs speak of it."""
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
        found = [
            python_string(connection.service),
            python_string(f"{request.package}/srv/{connection.type.name}"),
            self.translated.request_name,
            self.translated.response_name,
        ]
        members = {"success": connection.successMember, "reason": connection.reasonMember}
        found += [f"{key}={python_string(_path(path))}" for key, path in members.items() if path]
        return tuple(found)

    @property
    def argument_lines(self) -> tuple[str, ...]:
        """Arguments of the runtime class after the name."""
        connection = self.connection
        found = [
            ("service", call("RosService", *self.service_arguments)),
            ("request", self._request),
            ("response", self._half(calls.RESPONSE, calls.answering(connection))),
            ("peers", peers_of(connection)),
        ]
        if connection.rejections:
            names = ", ".join(self.view_of(each).class_name for each in connection.rejections)
            found.append(("rejections", f"[{names}]"))
        found += self._guarding
        found += priority_of(connection)
        found.append(("timeout", python_literal(float(connection.timeout))))
        return tuple(f"{key}={value}" for key, value in found)

    @property
    def _guarding(self) -> list[tuple[str, str]]:
        """Arguments that say whom to obey, or what of others is controlled."""
        connection, message = self.connection, calls.asking(self.connection)
        if message is None:
            return []
        found = []
        if is_command(message):
            found.append(("is_command", "True"))
        if calls.serves(connection):
            guard = guard_of_receivers(message, connection.peers, connection.search)
            if guard != "ANY" and connection.control:
                found.append(("control", f"Guard.{guard}"))
            if calls.maps_success(connection):
                found.append(("is_success_mapped", "True"))
        else:
            guard = guard_of_receivers(message, [connection.eContainer()], None)
            if guard != "ANY":
                found.append(("when", condition(message, guard)))
        return found

    @property
    def _request(self) -> str:
        """What asks: a translation, the message that is sent, or the class of what is taken."""
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
