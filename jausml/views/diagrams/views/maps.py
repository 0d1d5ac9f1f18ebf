"""The view of an attribute map: the members of both ends, and a line for each assignment."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import partial

from jausml.language.metamodel.classes import bridge
from jausml.language.model.model import Model
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.paths.scopes import COUNTERS, source_paths, target_paths
from jausml.views.diagrams.graph import (
    JAUS_COLUMN,
    ROS_COLUMN,
    Details,
    Edge,
    End,
    Finding,
    Graph,
    Node,
    Port,
)
from jausml.views.diagrams.views.context import Builder, Context, details, name_of, number
from jausml.views.diagrams.views.members import (
    Member,
    jaus_members,
    paths_of,
    plain,
    ros_members,
    rows,
)

_LONGEST_VALUE = 40


def offered(
    model: Model, *, library: bool
) -> Iterator[tuple[tuple[str, ...], Callable[[Context], Graph]]]:
    """Yields the views of maps: names, and what makes the graphs."""
    for attribute_map in model.instances(bridge.AttributeMap, library=library):
        if attribute_map.name:
            names = tuple(f"map:{name}" for name in names_of(attribute_map))
            yield names, partial(graph, attribute_map=attribute_map)


def names_of(attribute_map: bridge.AttributeMap) -> tuple[str, ...]:
    """Returns the names of a map in views: its own, and behind that of its bridge."""
    own, owner = name_of(attribute_map), attribute_map.eContainer()
    return (own, f"{owner.name}.{own}") if isinstance(owner, bridge.Bridge) else (own,)


class _Side:
    """One end of a map: a message, a type or a join, whose members assignments fill or read."""

    def __init__(self, node: str, members: tuple[Member, ...]) -> None:
        self.node = node
        self.members = members
        self.marks: dict[str, str] = {}
        self.unknown: dict[str, Port] = {}
        self._known = set(paths_of(members))

    def end(self, path: str, mark: str = "") -> End:
        """Returns the end at a member, which is shown then; an unknown one is made."""
        path = plain(path)
        if path in ("", "."):
            return End(self.node)
        if path in self._known:
            self.marks[path] = mark or self.marks.get(path, "")
        else:
            wrong = Finding("error", "", f"there is no member '{path}'")
            self.unknown[path] = Port(path, path, mark="unknown", findings=(wrong,))
        return End(self.node, path)

    def ports(self) -> tuple[Port, ...]:
        """Returns the rows."""
        return (*rows(self.members, self.marks), *self.unknown.values())


def graph(context: Context, attribute_map: bridge.AttributeMap) -> Graph:
    """Returns the view of a map."""
    return _MapView(context, attribute_map).graph()


def ends(
    context: Context, attribute_map: bridge.AttributeMap
) -> Iterator[tuple[str, tuple[Member, ...]]]:
    """Yields the boxes of the view of a map: their ids, and all their members.

    The view itself shows those of interest.
    """
    view = _MapView(context, attribute_map)
    for side in (view.jaus, view.ros, *view.joins.values()):
        yield side.node, side.members


class _MapView:
    def __init__(self, context: Context, attribute_map: bridge.AttributeMap) -> None:
        self.context = context
        self.map = attribute_map
        self.edges: list[Edge] = []
        message, kind = attribute_map.message, attribute_map.type
        own = context.id_of(attribute_map)
        self.jaus = _Side(f"{own}!jaus", jaus_members(context, message) if message else ())
        self.ros = _Side(f"{own}!ros", ros_members(context, kind) if kind else ())
        self.joins: dict[str, _Side] = {}
        for join in attribute_map.joins:
            members = ros_members(context, join.type) if join.type else ()
            self.joins[str(join.name)] = _Side(context.id_of(join), members)
        for report in attribute_map.reportJoins:
            members = jaus_members(context, report.message) if report.message else ()
            self.joins[str(report.name)] = _Side(context.id_of(report), members)

    def graph(self) -> Graph:
        """Returns the view."""
        for assignment in self.map.toRos:
            self._add(assignment, to_ros=True)
        for assignment in self.map.toJaus:
            self._add(assignment, to_ros=False)
        builder = Builder(self.context)
        for node in self._nodes():
            builder.add(node)
        builder.edges = self.edges
        return builder.graph(f"map {name_of(self.map)}", self.map)

    def _nodes(self) -> Iterable[Node]:
        """Returns the boxes: both ends, and the joins beside the end that they join."""
        own, message, kind = self.map, self.map.message, self.map.type
        yield Node(
            self.jaus.node,
            "message",
            name_of(message),
            f"JAUS {(message.code if message else '') or ''}".strip(),
            self.jaus.ports(),
            column=JAUS_COLUMN,
            details=details(message) if message else (),
            findings=self.context.findings(own, deep=False),
            element=self.context.reference(message),
        )
        for report in own.reportJoins:
            yield self._join(report, name_of(report.message), "message", JAUS_COLUMN)
        yield Node(
            self.ros.node,
            "type",
            ros_name(kind) if kind else "?",
            "ROS",
            self.ros.ports(),
            column=ROS_COLUMN,
            details=details(kind) if kind else (),
            element=self.context.reference(kind),
        )
        for join in own.joins:
            yield self._join(join, ros_name(join.type) if join.type else "?", "type", ROS_COLUMN)

    def _join(
        self, join: bridge.Join | bridge.ReportJoin, what: str, kind: str, column: int
    ) -> Node:
        side = self.joins[str(join.name)]
        return Node(
            side.node,
            kind,
            what,
            f"joined as {name_of(join)}",
            side.ports(),
            column=column,
            details=details(join, freshness=f"{number(join.freshness)} s"),
            findings=self.context.findings(join),
        )

    def _add(
        self,
        assignment: bridge.Assignment,
        source_base: str = "",
        target_base: str = "",
        *,
        to_ros: bool,
    ) -> None:
        """Adds the edges of an assignment, and those of nested ones."""
        target = self.ros if to_ros else self.jaus
        source = self.jaus if to_ros else self.ros
        mark = _mark(assignment)
        targets = [
            target.end(_below(target_base, target_path), mark)
            for target_path in target_paths(assignment)
        ]
        paths = [
            source_path for source_path in source_paths(assignment) if source_path not in COUNTERS
        ]
        sources = [self._source(path, source_base, source) for path in paths]
        pairs = [(source_end, targets[0]) for source_end in sources] if targets else []
        pairs += [(sources[0], target_end) for target_end in targets[1:]] if sources else []
        for index, (start, end) in enumerate(pairs):
            self._join_ends(assignment, start, end, index, to_ros=to_ros)
        if isinstance(assignment, bridge.ListAssignment):
            bases = (_below(source_base, paths[0]) if paths else source_base,
                     _below(target_base, (target_paths(assignment) or [""])[0]))  # fmt: skip
            for inner_assignment in assignment.assignments:
                self._add(inner_assignment, *bases, to_ros=to_ros)

    def _source(self, path: str, base: str, side: _Side) -> End:
        if path.startswith("/"):
            base, path = "", path[1:]
        first, _, rest = path.partition(".")
        if not base and first in self.joins:
            return self.joins[first].end(rest)
        return side.end(_below(base, path))

    def _join_ends(
        self, assignment: bridge.Assignment, start: End, end: End, index: int, *, to_ros: bool
    ) -> None:
        labels = tuple(_conversions(assignment)) if index == 0 else ()
        own = self.context.id_of(assignment)
        self.edges.append(
            Edge(
                f"{own}!{index}" if index else own,
                start,
                end,
                "to_ros" if to_ros else "to_jaus",
                f"{start.port} to {end.port}",
                labels,
                details=_details(assignment, labels),
                findings=self.context.findings(assignment) if index == 0 else (),
                element=self.context.reference(assignment),
            )
        )


def _below(base: str, path: str) -> str:
    return base if path == "." else f"{base}.{path}" if base else path


def _mark(assignment: bridge.Assignment) -> str:
    """Returns the mark at a member that is filled without a source."""
    match assignment:
        case bridge.ConstantAssignment():
            value = str(assignment.value or "")
            short = value if len(value) <= _LONGEST_VALUE else value[:_LONGEST_VALUE] + "…"
            return f"= {short}" if short else '= ""'
        case bridge.ClockAssignment():
            return "= clock"
        case bridge.Ignore():
            return "ignored"
        case _:
            return ""


def _details(assignment: bridge.Assignment, labels: tuple[str, ...]) -> Details:
    known: dict[str, object] = defaultdict(str)
    if isinstance(assignment, bridge.FieldAssignment):
        known["when absent"] = assignment.whenAbsent.name
        known["default"] = assignment.defaultValue
    return details(assignment, conversions=", then ".join(labels), **known)


def _conversions(assignment: bridge.Assignment) -> Iterator[str]:
    """Yields the conversions of an assignment, in words."""
    if isinstance(assignment, bridge.MessageAssignment):
        yield f"by map {name_of(assignment.map)}"
    if not isinstance(assignment, bridge.FieldAssignment | bridge.ListAssignment):
        return
    for conversion in assignment.conversions:
        more = [number(value) for value in conversion.arguments]
        more += [str(conversion.expression)] if conversion.expression else []
        more += [str(conversion.method)] if conversion.method else []
        more += [str(conversion.units)] if conversion.units else []
        more += [name_of(conversion.table)] if conversion.table is not None else []
        more += [name_of(conversion.quantity)] if conversion.quantity is not None else []
        yield " ".join([conversion.kind.name, *more])
