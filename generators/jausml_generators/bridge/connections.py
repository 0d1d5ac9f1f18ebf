"""View of one connection, for the templates of a bridge package."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from jausml.generation.literals import python_literal, python_string
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.assignments.named_places import NamedPlaces, named_places
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.calls import told_command
from jausml.language.semantics.connections.reports import JoinedReport, freshness_of, joined_reports
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import chosen_fields, guard_of_receivers, is_emergency
from jausml_generators.bridge.ends import (
    JoinView,
    ReportJoinView,
    list_of,
    peers_of,
    priority_of,
    query_call,
    query_of,
    query_of_join,
    topic_call,
)
from jausml_generators.bridge.translation.translating import Translated
from jausml_generators.common.ros import RosType, ros_type
from jausml_generators.python.codec.message_builder import build_unnamed
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.statements import call, condition, tuple_of


@dataclass(frozen=True)
class ConnectionView:
    """A modelled connection."""

    connection: bridge.Connection
    translated: Translated
    view_of: Callable[[jaus.MessageDef], MessageView]
    requested: Mapping[jaus.MessageDef, frozenset[str]] = field(default_factory=dict)

    # ------------------------------------------------------------------ both ends

    @property
    def owner(self) -> bridge.Bridge | None:
        """The bridge in the model."""
        return self.connection.eContainer()

    @property
    def name(self) -> str:
        """Its name in Python."""
        return self.translated.name

    @property
    def model_name(self) -> str:
        """Its name in the model, also in diagnostics, parameters and logs."""
        return str(self.connection.name)

    @property
    def alike(self) -> object:
        """The key that connections share whose translations differ in their own name alone."""
        return self.translated.alike

    @property
    def compiled_mark(self) -> str:
        """The decorator that names its compiled form, as Python text; empty without one."""
        compiled = self.translated.compiled
        if compiled is None or self._named is not None:
            return ""
        arguments = [python_string(compiled.function)]
        for name in ("quantities", "texts", "joins", "unknown"):
            values = getattr(compiled, name)
            arguments += [f"{name}={tuple_of(*map(python_string, values))}"] if values else []
        arguments += ["needs_clock=True"] if compiled.needs_clock else []
        return call("CORE.function", *arguments)

    @property
    def ros_name(self) -> str:
        """Name of its ROS message class in the generated modules."""
        return self.translated.ros_name

    @functools.cached_property
    def to_ros(self) -> bool:
        """True from JAUS to ROS."""
        return is_to_ros(self.connection)

    @functools.cached_property
    def exchange(self) -> str:
        """Literal of Exchange."""
        return str(self.connection.exchange.name)

    def unnamed(self) -> ConnectionView:
        """Returns the view with the form of its message for the message."""
        form = build_unnamed(self.message)
        own = self.message_element
        return replace(
            self, view_of=lambda element: form if element is own else self.view_of(element)
        )

    @property
    def message_element(self) -> jaus.MessageDef:
        """The JAUS message in the model."""
        return self.connection.map.message

    @functools.cached_property
    def message(self) -> MessageView:
        """The JAUS message."""
        return self.view_of(self.message_element)

    @property
    def message_name(self) -> str:
        """Class of the JAUS message."""
        return self.message.class_name

    @property
    def ros_type(self) -> RosType:
        """The ROS type."""
        return ros_type(self.connection.map.type)

    @property
    def source_name(self) -> str:
        """Class of the message that is taken."""
        return self.message_name if self.to_ros else self.ros_name

    @property
    def target_name(self) -> str:
        """Class of the message that is made."""
        return self.ros_name if self.to_ros else self.message_name

    @functools.cached_property
    def kind(self) -> str:
        """Class of the runtime that carries it."""
        if self.to_ros:
            kinds = {"message": "MessageToTopics", "query": "QueryToTopics"}
            return kinds.get(self.exchange, "EventToTopics")
        return "TopicsToMessage" if self.exchange == "message" else "TopicsToReport"

    @property
    def summary(self) -> str:
        """The source and target, e.g. `ReportLocalPose (0x4403) to nav_msgs/Odometry`."""
        ends = (
            f"{self.message.jaus_name} ({self.message.code_text})",
            f"{self.ros_type.package}/{self.ros_type.name}",
        )
        source, target = ends if self.to_ros else ends[::-1]
        return f"{source} to {target}"

    @property
    def documentation(self) -> str:
        """The summary of the connection, and its documentation in the model."""
        about = self.connection.documentation or ""
        return "\n\n".join(filter(None, [f"{self.summary}.", about, self._about_map]))

    @property
    def _about_map(self) -> str:
        return self.connection.map.documentation or ""

    # ------------------------------------------------------------------ JAUS messages

    @property
    def query_element(self) -> jaus.MessageDef | None:
        """The query for the report in the model; None when the connection needs none."""
        return query_of(self.connection)

    @functools.cached_property
    def query(self) -> MessageView | None:
        """The query for the report; None when the connection needs none."""
        return None if self.query_element is None else self.view_of(self.query_element)

    # ------------------------------------------------------------------ construction

    @property
    def arguments(self) -> tuple[tuple[str, str], ...]:
        """Arguments of the runtime class after name and translate."""
        arguments = [("message", self.message_name), ("type", self.ros_name)]
        if self.query is not None:
            query = (
                query_call(
                    self.query, self.message, self.requested.get(self.message_element, frozenset())
                )
                if self.to_ros
                else self.query.class_name
            )
            arguments.append(("query", query))
        if self.rate is not None:
            arguments.append(("rate", python_literal(self.rate)))
        if self._handler_guard != "ANY":
            arguments.append(("when", condition(self.message_element, self._handler_guard)))
        if self.kind == "MessageToTopics":
            arguments += self._telling()
        if self.is_capped and self.connection.rateCap > 0:
            arguments.append(("rate_cap", python_literal(float(self.connection.rateCap))))
        if self._named is not None:
            lists = (self._named.names, self._named.arrays)
            stated = (tuple_of(*map(python_string, string_list)) for string_list in lists)
            places_call = call("NamedPlaces", python_string(self._named.keys), *stated)
            arguments.append(("named", places_call))
        if self.kind == "TopicsToMessage":
            arguments += self._sending()
        if self.kind == "TopicsToReport":
            arguments += self._reporting()
        return (*arguments, *self._shape, *self._when_lost)

    @property
    def _named(self) -> NamedPlaces | None:
        """The elements of its source that are put in order by their names."""
        return None if self.to_ros else named_places(self.connection.map)

    @property
    def is_capped(self) -> bool:
        """Whether it can have a limit on unrequested messages of one source."""
        return self.kind == "MessageToTopics"

    @property
    def _shape(self) -> list[tuple[str, str]]:
        own = self.connection
        stated = [
            *([f"max_rate={python_literal(float(own.maxRate))}"] if own.maxRate > 0 else []),
            *([f"decimation={int(own.decimation)}"] if own.decimation > 1 else []),
            *([f"age_limit={python_literal(float(own.ageLimit))}"] if own.ageLimit > 0 else []),
        ]
        return [("shape", call("Shape", *stated))] if stated else []

    @property
    def _when_lost(self) -> list[tuple[str, str]]:
        arguments = []
        if self.is_command:
            arguments.append(("is_command", "True"))
        if self.silence_timeout > 0:
            arguments.append(("silence_timeout", python_literal(self.silence_timeout)))
        if self.has_safe_value:
            arguments.append(("safe_value", f"self.safe_{self.name}"))
            if values := stops.stop_values(self.connection):
                arguments.append(("stop", f"({', '.join(map(python_string, values))},)"))
        elif self.is_command and stops.keeps_last_command(self.connection):
            arguments.append(("hold_reason", python_string(stops.hold_reason(self.connection))))
        return arguments

    def _sending(self) -> list[tuple[str, str]]:
        arguments = []
        if self.connection.control and self.guard != "ANY":
            arguments.append(("control", f"Guard.{self.guard}"))
        arguments += priority_of(self.connection)
        if self.connection.acknowledge:
            arguments.append(("acknowledge", "True"))
        if is_emergency(self.message_element):
            arguments.append(("filters", "True"))
        return arguments

    def _telling(self) -> list[tuple[str, str]]:
        """Returns the query and the report by which the command is read."""
        answer = told_command(self.connection)
        if answer is None:
            return []
        query, report = self.view_of(answer.query), self.view_of(answer.report)
        arguments = [query.class_name, report.class_name]
        chosen = [query.find(name)[0].attribute for name in chosen_fields(answer) or ()]
        if chosen:
            arguments.append(f"same={tuple_of(*map(python_string, chosen))}")
        if all(member.is_optional for member in report.body.members):
            arguments.append("has_empty=True")
        return [("answer", call("CommandAnswer", *arguments))]

    def _reporting(self) -> list[tuple[str, str]]:
        arguments = []
        freshness = freshness_of(self.connection)
        if freshness:
            arguments.append(("freshness", python_literal(freshness)))
        if all(member.is_optional for member in self.message.body.members):
            arguments.append(("empty", self.message_name))
        return arguments

    @property
    def rate(self) -> float | None:
        """Messages each second that are asked for, 0 for as many as the frequency of the bridge.

        None when nothing is asked for, or every change.
        """
        if not self.to_ros or self.exchange not in {"periodicEvent", "query"}:
            return None
        return float(self.connection.rate)

    @property
    def named_peers(self) -> list[str]:
        """Addresses of the JAUS components at the other end that are named."""
        if self.kind == "TopicsToReport" or self._bound.search is not None:
            return []
        return [str(peer.address) for peer in self._bound.peers]

    @property
    def peers(self) -> str:
        """Addresses of the JAUS components at the other end, or how they are found."""
        return peers_of(self._bound)

    @property
    def _bound(self) -> bridge.Connection | bridge.RosActionConnection:
        """The element of the model that names the other end."""
        return self.connection

    @property
    def topics(self) -> tuple[str, ...]:
        """The topics with their quality of service."""
        topics = self.connection.topics
        return tuple(topic_call(self.connection, topic) for topic in topics if topic.join is None)

    @property
    def argument_lines(self) -> tuple[str, ...]:
        """Arguments of the runtime class after name and translate."""
        lines = [f"{key}={value}" for key, value in self.arguments]
        if self.kind != "TopicsToReport":
            lines.append(f"peers={self.peers}")
        lines.append(f"topics={list_of(self.topics)}")
        if self.joins:
            lines.append(f"joins={list_of(join.argument for join in self.joins)}")
        return tuple(lines)

    @property
    def guard(self) -> str:
        """Whom the receiver of a command obeys: the bridge itself, or its peers (AS5710)."""
        receivers = [self.connection.eContainer()] if self.to_ros else self.connection.peers
        search = None if self.to_ros else self.connection.search
        return guard_of_receivers(self.message_element, receivers, search)

    @property
    def _handler_guard(self) -> str:
        return self.guard if self.kind == "MessageToTopics" else "ANY"

    # ------------------------------------------------------------------ translation

    @functools.cached_property
    def joins(self) -> tuple[JoinView | ReportJoinView, ...]:
        """The joins, whose latest messages are parameters of the translation."""
        if self.to_ros:
            names = {join.join: join.name for join in self.translated.joins}
            reports = joined_reports(self.connection)
            return tuple(self._joined_report(report, names[report.join]) for report in reports)
        return tuple(
            JoinView(self.connection, join.join, join.name, join.type_name)
            for join in self.translated.joins
            if isinstance(join.join, bridge.Join)
        )

    def _joined_report(self, report: JoinedReport, name: str) -> ReportJoinView:
        message, query = self.view_of(report.join.message), query_of_join(report)
        requested = self.requested.get(report.join.message, frozenset())
        asked = "" if query is None else query_call(self.view_of(query), message, requested)
        return ReportJoinView(report, name, message, asked)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Parameters of the translation."""
        joins = (f"{join.name}: {join.type_name} | None = None" for join in self.joins)
        return ("self", f"source: {self.source_name}", *joins)

    @property
    def safe_documentation(self) -> str:
        """When the safe value is sent."""
        silence = ""
        if self.silence_timeout > 0:
            seconds = python_literal(self.silence_timeout)
            silence = f"when {self.connection.name} hears nothing for {seconds} s"
        if not self.is_command:
            return f"Sent once {silence}."
        lost = "at the start, at the end, when nobody may command any more"
        moments = f"{lost}, and {silence}" if silence else lost
        return f"Stops what was commanded.\n\nSent once {moments}."

    @functools.cached_property
    def is_command(self) -> bool:
        """Whether it carries commands, which set something in motion."""
        return stops.carries_commands(self.connection)

    @functools.cached_property
    def silence_timeout(self) -> float:
        """Seconds of silence that count as a loss of the source; 0 is never."""
        return stops.silence_timeout(self.connection)

    @property
    def longest_silence(self) -> float:
        """Seconds without a message after which a source is lost or a report is stale."""
        return self.silence_timeout or freshness_of(self.connection)

    @functools.cached_property
    def has_safe_value(self) -> bool:
        """Whether the model states a stop for a lost source, and the source can be lost."""
        can_be_lost = self.is_command or self.silence_timeout > 0
        return can_be_lost and stops.has_stop(self.connection)
