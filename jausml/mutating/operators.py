"""The operators: what is broken in a model, and how."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from jausml.language.metamodel import ClassTable
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions import NEGATION
from jausml.language.semantics.paths.attributes import NUMBER, Attribute
from jausml.language.semantics.paths.scopes import flattened, has_source, outer_scope
from jausml.mutating.changes import (
    Change,
    Site,
    Together,
    crossed_members,
    exchanged_entries,
    next_entry,
    other_member,
    other_state,
    other_unit,
    partner,
)


@dataclass(frozen=True)
class Operator:
    """A way to break a model.

    Attributes:
        values: Yields what a feature holds afterwards, one value for each mutation; or changes, of
            other elements too, that are made together.
        features: What it changes: each class, a blank, and names of its features; commas between.
    """

    name: str
    does: str
    values: Callable[[Site], Iterator[Any]]
    features: str

    def of_classes(self) -> Iterator[tuple[str, list[str]]]:
        """Yields each class with the names of its features."""
        for word in self.features.split(", "):
            name, *features = word.split()
            yield name, features

    def changes(self, site: Site) -> Iterator[Change | Together]:
        """Yields the changes of a feature that change a value."""
        for value in self.values(site):
            if isinstance(value, Together):
                yield value
            elif value != site.value:
                yield Change(site.element, site.feature, value)


def _ends(site: Site) -> list[Attribute]:
    """Returns source and target of an assignment of one number to another, else an empty list."""
    placed = site.placed
    if placed is None:
        return []
    ends = [*placed.source_attributes, *placed.target_attributes]
    return ends if len(ends) == 2 and all(end.kind == NUMBER for end in ends) else []


def _negated(site: Site) -> Iterator[Any]:
    kinds = [str(conversion.kind) for conversion in site.value]
    if NEGATION.name in kinds:
        at = kinds.index(NEGATION.name)
        yield site.value[:at] + site.value[at + 1 :]
    else:
        yield from _followed_by(NEGATION.name)(site)


def _negated_both_ways(site: Site) -> Iterator[Together]:
    back = partner(site.placed)
    if back is None or any(end.named for end in _ends(site)):
        return
    sites = (Site(element, site.feature, site.placed) for element in (site.element, back))
    for there, behind in zip(*map(_negated, sites), strict=False):
        elements = zip((site.element, back), (there, behind), strict=True)
        yield Together(tuple(Change(element, site.feature, value) for element, value in elements))


def _one_that_drives(site: Site) -> Iterator[Any]:
    """Yields a stop that sends 1 in the first number that its map fills and it leaves out."""
    map_ = site.element.eContainer()
    to_ros = site.element.eContainmentFeature().name == "stopRos"
    scope = outer_scope(map_, to_ros=to_ros)
    said = {str(value.target) for value in site.value}
    for placed in flattened(map_.toRos if to_ros else map_.toJaus, scope):
        for path, target in () if placed.scope.is_nested else placed.targets:
            is_number = isinstance(target, Attribute) and target.kind == NUMBER
            if is_number and has_source(placed.assignment) and path not in said:
                constant: Any = bridge.ConstantAssignment()
                constant.target, constant.value = path, "1"
                yield [*site.value, constant]
                return


def _followed_by(kind: str, *arguments: float) -> Callable[[Site], Iterator[Any]]:
    """Returns a mutator that gives an assignment of a number one more conversion."""

    def values(site: Site) -> Iterator[Any]:
        if _ends(site) and not any(end.named for end in _ends(site)):
            yield [*site.value, _conversion(site, kind, *arguments)]

    return values


def _conversion(site: Site, kind: str, *arguments: float) -> Any:
    conversion: Any = bridge.Conversion()
    conversion.kind = _literals(site.feature.target, "kind")[kind]
    conversion.arguments.extend(arguments)
    return conversion


def _literals(table: ClassTable | None, name: str) -> Mapping[str, Any]:
    data_type = table.features[name].data_type if table is not None else None
    return data_type.literals if data_type is not None else {}


def _times(factor: float) -> Callable[[Site], Iterator[Any]]:
    """Returns a mutator that multiplies a number, unless it is zero or not stated."""

    def values(site: Site) -> Iterator[Any]:
        if site.feature.many:
            for at, number in enumerate(site.value):
                yield [*site.value[:at], number * factor, *site.value[at + 1 :]]
        elif site.value:
            whole = isinstance(site.value, int)
            yield max(round(site.value * factor), 1) if whole else site.value * factor

    return values


def _longer_or_left_out(site: Site) -> Iterator[Any]:
    yield from _times(10)(site)
    if site.value:
        yield site.feature.default


def _left_out(site: Site) -> Iterator[Any]:
    if site.feature.many:
        for at in range(len(site.value)):
            yield site.value[:at] + site.value[at + 1 :]
    elif site.value is not None:
        yield site.feature.default


def _exchanged(site: Site) -> Iterator[Any]:
    values = site.value
    for at in range(len(values) - 1):
        yield [*values[:at], values[at + 1], values[at], *values[at + 2 :]]


def _one_more(site: Site) -> Iterator[Any]:
    if isinstance(site.value, str):  # the code of a message
        yield f"0x{int(site.value, 16) + 1:04X}"
    elif site.value is not None:
        yield site.value + 1


def _other(site: Site) -> Iterator[Any]:
    """Yields the next value of an enumeration, or the other truth value."""
    if isinstance(site.value, bool):
        yield not site.value
    elif site.feature.data_type is not None:
        values = list(site.feature.data_type.literals.values())
        yield values[(values.index(site.value) + 1) % len(values)]


def _other_where_stated(site: Site) -> Iterator[Any]:
    if site.value != site.feature.default:
        yield from _other(site)


def _other_constant(site: Site) -> Iterator[Any]:
    text = site.value
    if not text:
        return
    if text in ("true", "false"):
        yield "false" if text == "true" else "true"
        return
    try:
        yield str(int(text) + 1)
    except ValueError:
        try:
            yield str(float(text) + 0.125)
        except ValueError:
            yield f"{text}_2"


def _no_text(site: Site) -> Iterator[Any]:
    if site.value:
        yield None


OPERATORS = (
    Operator(
        "sign",
        "negates a number, or no longer does",
        _negated,
        "bridge.FieldAssignment conversions",
    ),
    Operator(
        "sign both ways",
        "negates a number, or no longer does, in both directions",
        _negated_both_ways,
        "bridge.FieldAssignment conversions",
    ),
    Operator(
        "factor",
        "multiplies a number by 1.1",
        _followed_by("scale", 1.1),
        "bridge.FieldAssignment conversions",
    ),
    Operator(
        "offset",
        "adds 0.125 to a number",
        _followed_by("linear", 1.0, 0.125),
        "bridge.FieldAssignment conversions",
    ),
    Operator(
        "figure",
        "multiplies an argument, a limit of a range or a quantity by 1.1",
        _times(1.1),
        "bridge.Conversion arguments, bridge.Quantity value, jaus.ScaleRange lower upper, "
        "jaus.ValueRange lower upper, ros.PrimitiveField minimum maximum, ros.Parameter "
        "minimum maximum",
    ),
    Operator(
        "conversion",
        "leaves out a conversion",
        _left_out,
        "bridge.FieldAssignment conversions, bridge.ListAssignment conversions",
    ),
    Operator(
        "member",
        "reads or fills the next member of the same kind",
        other_member,
        "bridge.FieldAssignment source target",
    ),
    Operator(
        "members both ways",
        "exchanges two members of the same kind in both directions",
        crossed_members,
        "bridge.FieldAssignment target",
    ),
    Operator(
        "assignment",
        "leaves out an assignment",
        _left_out,
        "bridge.AttributeMap toRos toJaus, bridge.ListAssignment assignments",
    ),
    Operator(
        "constant",
        "sets another constant, default or parameter",
        _other_constant,
        "bridge.ConstantAssignment value, bridge.FieldAssignment defaultValue, ros.Constant "
        "value, ros.PrimitiveField defaultValue, ros.Parameter value",
    ),
    Operator(
        "unit",
        "states another unit of the same dimension",
        other_unit,
        "bridge.Conversion units, bridge.Quantity units, jaus.FixedField units, "
        "jaus.Alternative units, ros.Field units",
    ),
    Operator(
        "frame",
        "states another frame, or none",
        _other_where_stated,
        "jaus.Field frame, ros.Field frame",
    ),
    Operator(
        "table entry",
        "gives an entry the value of the next one",
        next_entry,
        "bridge.TableEntry jaus ros",
    ),
    Operator(
        "entries",
        "exchanges what two neighbours of a table stand for",
        exchanged_entries,
        "bridge.TableEntry ros",
    ),
    Operator(
        "table", "leaves out an entry", _left_out, "bridge.ValueTable entries, jaus.ValueSet values"
    ),
    Operator(
        "number of a name",
        "adds one to the number of a value, a code or a bit",
        _one_more,
        "jaus.EnumeratedValue value, jaus.MessageDef code, jaus.SubField lowBit highBit",
    ),
    Operator(
        "order",
        "exchanges two neighbours of a list whose order counts",
        _exchanged,
        "bridge.FieldAssignment conversions, bridge.Conversion arguments, jaus.Record fields, "
        "jaus.Sequence fields, jaus.Variant options, ros.MessageType fields, jaus.State "
        "transitions",
    ),
    Operator(
        "rate",
        "halves a rate, and what else limits how often something is sent",
        _times(0.5),
        "bridge.Connection rate rateCap maxRate, bridge.ReportSource rate, "
        "jaus.ServiceConnection rate, ros.Node frequency, bridge.Bridge frequency",
    ),
    Operator(
        "time-out",
        "makes a time ten times as long, or leaves it out",
        _longer_or_left_out,
        "bridge.Connection silenceTimeout freshness ageLimit, bridge.AttributeMap freshness, "
        "bridge.Stop silenceTimeout, bridge.Join freshness, bridge.ReportJoin freshness, "
        "bridge.RosServiceConnection timeout, bridge.RosActionConnection timeout, "
        "jaus.ServiceConnection silenceTimeout, jaus.Component controlTimeout eventTimeout",
    ),
    Operator(
        "stop",
        "leaves out a value of a stop, or the stop",
        _left_out,
        "bridge.Connection safeValue, bridge.AttributeMap stopRos stopJaus, bridge.Stop values",
    ),
    Operator(
        "stop that drives",
        "sends 1 in a number of which a stop says nothing",
        _one_that_drives,
        "bridge.Stop values",
    ),
    Operator(
        "QoS",
        "states another quality of service, or doubles its figure",
        _other,
        "ros.QoSProfile reliability durability history liveliness",
    ),
    Operator(
        "figure of QoS",
        "doubles the depth or a time",
        _times(2),
        "ros.QoSProfile depth deadline lifespan leaseDuration",
    ),
    Operator(
        "policy",
        "states another policy, exchange or priority",
        _other,
        "bridge.FieldAssignment whenAbsent outOfRange, bridge.ListAssignment whenAbsent, "
        "bridge.AttributeMap whenStale, bridge.Join whenStale, bridge.ReportJoin whenStale, "
        "bridge.Connection exchange outOfRange onSilence whenStale priority acknowledge, "
        "bridge.RosServiceConnection outOfRange priority, bridge.RosActionConnection "
        "outOfRange progress onEnd, bridge.ReportSource exchange, jaus.ServiceConnection exchange",
    ),
    Operator(
        "control",
        "turns what says who may command",
        _other,
        "bridge.Connection control, bridge.RosServiceConnection control, "
        "bridge.RosActionConnection control, jaus.MessageDef isCommand moves",
    ),
    Operator(
        "authority", "halves an authority", _times(0.5), "jaus.Component authority defaultAuthority"
    ),
    Operator(
        "wiring",
        "leaves out a peer, a service, a topic or who is controlled",
        _left_out,
        "bridge.Connection peers topics, bridge.RosServiceConnection peers, "
        "bridge.RosActionConnection peers, jaus.Component provides uses controls connections, "
        "ros.Node publishers subscriptions",
    ),
    Operator(
        "topic",
        "names another topic",
        _other_constant,
        "ros.TopicEndpoint topic, bridge.Topic name",
    ),
    Operator("guard", "leaves out the guard of a transition", _no_text, "jaus.Transition guard"),
    Operator(
        "target", "leads a transition to another state", other_state, "jaus.Transition target"
    ),
    Operator(
        "behaviour",
        "leaves out a transition or an action",
        _left_out,
        "jaus.State transitions defaults entry exit, jaus.Transition actions",
    ),
)
"""All operators."""
