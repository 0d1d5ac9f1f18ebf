"""The last message of one connection on both sides, while a user looks at it."""

from __future__ import annotations

import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.live.messages import MessageError
from jausml.live.peers.entry_messages import full_query, message_class
from jausml.live.peers.network import component_address
from jausml.live.peers.rendering import field_texts

if TYPE_CHECKING:
    from jausml.live.messages import MessageEntry
    from jausml.live.peers.entry_messages import EntryMessage
    from jausml.live.peers.operator import Operator
    from jausml.live.systems.ros_diagnostics import RosDiagnostics
    from jausml.live.systems.state import ConnectionState, DeclaredConnection, TopicName

PAUSE = 1.0  # seconds between two queries of a report

MOST_LINES = 60  # of a shown message

_NO_MODEL = "which it is says the model: jausml top MODEL"


class Inspection:
    """Subscribes to the topic of one connection at a time, and queries its report."""

    def __init__(self, operator: Operator | None, ros: RosDiagnostics | None) -> None:
        """Begins without a connection; without ROS or JAUS, `at` says so."""
        self._operator = operator
        self._ros = ros
        self._key: tuple[str, str] | None = None
        self._topic: TopicName | None = None
        self._ros_fault = ""
        self._jaus: list[str] = []
        self._next = 0.0
        self._threads = ThreadPoolExecutor(max_workers=1, thread_name_prefix="inspection")
        self._pending: Future[None] | None = None

    def at(self, connection: ConnectionState) -> tuple[list[str], list[str]]:
        """Returns the last message of a connection in ROS and in JAUS, as lines; never waits."""
        if connection.key != self._key:
            self.away()
            self._key = connection.key
            self._begin(connection)
        self._query_report(connection)
        return self._ros_lines(), list(self._jaus)

    def away(self) -> None:
        """Ends the subscription and the queries."""
        if self._ros is not None:
            self._ros.unwatch()
        self._key, self._topic, self._ros_fault, self._jaus = None, None, "", []
        self._next = 0.0

    def close(self) -> None:
        """Ends the subscription, the queries and the thread."""
        self.away()
        self._threads.shutdown()

    # ---- ROS --------------------------------------------------------------------------------

    def _begin(self, connection: ConnectionState) -> None:
        declaration = connection.declaration
        if self._ros is None:
            self._ros_fault = "there is no ROS here"
        elif declaration is None:
            self._ros_fault = _NO_MODEL
        elif not declaration.topics:
            self._ros_fault = "the connection has no topic"
        else:
            self._topic = topic_of(connection, declaration)
            self._ros_fault = self._ros.watch(self._topic)

    def _ros_lines(self) -> list[str]:
        if self._ros is None or self._topic is None or self._ros_fault:
            return [self._ros_fault]
        lines = self._ros.latest()[:MOST_LINES] or ["nothing has come since this panel is open"]
        return [f"{self._topic.name} ({self._topic.type})", *lines]

    # ---- JAUS -------------------------------------------------------------------------------

    def _query_report(self, connection: ConnectionState) -> None:
        """Queries the report once in `PAUSE`; messages to other components cannot be seen."""
        declaration, operator = connection.declaration, self._operator
        if operator is None:
            self._jaus = ["there is no JAUS here"]
        elif declaration is None:
            self._jaus = [_NO_MODEL]
        elif not declaration.is_report:
            message = declaration.message
            self._jaus = [f"{message}: not observable; a command goes to its receiver alone"]
        elif not reporters_of(connection, declaration):
            self._jaus = [f"{declaration.message}: no component is known that could be asked"]
        elif time.monotonic() >= self._next and (self._pending is None or self._pending.done()):
            self._next = time.monotonic() + PAUSE
            target = reporters_of(connection, declaration)[0]
            self._pending = self._threads.submit(
                self._query, operator, connection.key, target, declaration.message
            )

    def _query(self, operator: Operator, key: tuple[str, str], target: str, name: str) -> None:
        """Queries a report; on another thread, as finding the message may take queries, too."""

        def take(report: EntryMessage | None) -> None:
            if self._key == key:
                self._jaus = [f"{name} of {target}", *_report_lines(report)]

        try:
            address = component_address(target)
            query, report = operator.exchange(address, name)
            message = operator.message(query, full_query(query, report))
            operator.ask_once(address, message, message_class(report), take)
        except (MessageError, ValueError) as error:
            if self._key == key:
                self._jaus = [f"{name} of {target}: {error}"]


def topic_of(connection: ConnectionState, declaration: DeclaredConnection) -> TopicName:
    """Returns the first topic of a connection, in the namespace in which its bridge runs."""
    return placed(connection, declaration.bridge, declaration.topics[0])


def placed(connection: ConnectionState, modelled: str, topic: TopicName) -> TopicName:
    """Returns a topic in the namespace in which the bridge of a connection runs.

    `modelled`: the full node name of the bridge in the model.
    """
    there = modelled.rpartition("/")[0] + "/"
    here = connection.bridge.rpartition("/")[0] + "/"
    if topic.is_absolute or not topic.name.startswith(there):
        return topic
    return replace(topic, name=here + topic.name.removeprefix(there))


def reporters_of(connection: ConnectionState, declaration: DeclaredConnection) -> list[str]:
    """Returns the JAUS ids of the components that send the report of a connection."""
    if declaration.direction == "to JAUS":
        return [connection.jaus_id]
    named = [key.partition(" ")[2] for key in connection.peers if key.startswith("peer ")]
    return named or list(declaration.peers)


def _report_lines(report: EntryMessage | None) -> list[str]:
    if report is None:
        return ["no answer"]
    entry: MessageEntry = report.ENTRY
    return [f"{path}: {text}" for path, text in field_texts(entry.record, report.fields)][
        :MOST_LINES
    ]
