"""The operators: what is broken in a model, and how."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from jausml.language.attributes.units import UnitError, conversion_between, parse_unit
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions import NEGATION
from jausml.language.semantics.paths.attributes import NUMBER
from jausml.mutating.changes import Change, exchanged, held, without_each

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from jausml.language.metamodel import ClassTable, FeatureTable
    from jausml.language.semantics.paths.attributes import Attribute
    from jausml.language.semantics.paths.scopes import Placed


@dataclass(frozen=True)
class Site:
    """A feature of an element that an operator may change."""

    element: Any
    feature: FeatureTable
    placed: Placed[Any] | None

    @cached_property
    def value(self) -> Any:
        """What the feature holds; a list where it has many values."""
        return held(self.element, self.feature)


@dataclass(frozen=True)
class Operator:
    """A way to break a model.

    Attributes:
        features: Names of the features that it changes, by the class that has them.
        values: Yields what a feature holds afterwards, one value for each mutation.
    """

    name: str
    does: str
    features: Mapping[str, str]
    values: Callable[[Site], Iterator[Any]]

    def changes(self, site: Site) -> Iterator[Change]:
        """Yields the changes of a feature, of those that change something."""
        for value in self.values(site):
            if value != site.value:
                yield Change(site.element, site.feature, value)


def _ends(site: Site) -> list[Attribute]:
    """Returns source and target of an assignment of one number to another, else nothing."""
    placed = site.placed
    if placed is None:
        return []
    ends = [*placed.source_attributes, *placed.target_attributes]
    return ends if len(ends) == 2 and all(each.kind == NUMBER for each in ends) else []


def _negated(site: Site) -> Iterator[Any]:
    kinds = [str(each.kind) for each in site.value]
    if NEGATION.name in kinds:
        at = kinds.index(NEGATION.name)
        yield site.value[:at] + site.value[at + 1 :]
    elif _ends(site) and not any(each.named for each in _ends(site)):
        yield [*site.value, _conversion(site, NEGATION.name)]


def _scaled_on(site: Site) -> Iterator[Any]:
    if _ends(site) and not any(each.named for each in _ends(site)):
        yield [*site.value, _conversion(site, "scale", 1.1)]


def _moved_on(site: Site) -> Iterator[Any]:
    if _ends(site) and not any(each.named for each in _ends(site)):
        yield [*site.value, _conversion(site, "linear", 1.0, 0.125)]


def _conversion(site: Site, kind: str, *arguments: float) -> Any:
    made: Any = bridge.Conversion()
    made.kind = _literals(site.feature.target, "kind")[kind]
    made.arguments.extend(arguments)
    return made


def _literals(table: ClassTable | None, name: str) -> Mapping[str, Any]:
    data_type = table.features[name].data_type if table is not None else None
    return data_type.literals if data_type is not None else {}


def _times(factor: float) -> Callable[[Site], Iterator[Any]]:
    """Returns what multiplies a number; what is zero or not given is no number to multiply."""

    def values(site: Site) -> Iterator[Any]:
        if site.feature.many:
            for at, each in enumerate(site.value):
                yield [*site.value[:at], each * factor, *site.value[at + 1 :]]
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
        yield from without_each(site.value)
    elif site.value is not None:
        yield site.feature.default


def _exchanged(site: Site) -> Iterator[Any]:
    yield from exchanged(site.value)


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


_UNITS = (
    *("millimeter", "kilometer per hour", "degree", "degree per second", "millisecond", "hour"),
    *("kilonewton", "gram", "degree Fahrenheit", "kilopascal", "millivolt", "milliampere"),
    *("kilohertz", "kilowatt", "liter", "1"),
)


def _other_unit(site: Site) -> Iterator[Any]:
    """Yields the first unit that measures the same by another factor."""
    try:
        unit = parse_unit(site.value or "")
    except UnitError:
        return
    for each in _UNITS:
        try:
            if conversion_between(unit, parse_unit(each)) != (1.0, 0.0):
                yield each
                return
        except ValueError:  # another dimension
            continue


def _other_member(site: Site) -> Iterator[Any]:
    """Yields the path of the next member of the same kind beside the one of a path."""
    if site.placed is None or not site.value or "," in site.value:
        return
    scope, is_source = site.placed.scope, site.feature.name == "source"
    find = scope.find_source if is_source else scope.find_target
    before, dot, name = site.value.rpartition(".")
    owner = find(before or ".")
    own = scope.followed.attribute(find(site.value))
    names = [str(each.name) for each in _members(owner)]
    if name not in names:
        return
    at = names.index(name)
    for each in names[at + 1 :] + names[:at]:
        other = scope.followed.attribute(find(f"{before}{dot}{each}"))
        if _is_alike(own, other):
            yield f"{before}{dot}{each}"
            return


def _members(owner: Any) -> list[Any]:
    if callable(getattr(owner, "members", None)):
        return list(owner.members() or ())
    kind = getattr(owner, "type", None)
    return list(kind.fields) if kind is not None else []


def _is_alike(one: Any, other: Any) -> bool:
    """Whether one attribute can stand where the other does."""
    same = ("kind", "integral", "named", "units")
    return bool(getattr(one, "kind", "")) and all(
        getattr(one, each, None) == getattr(other, each, None) for each in same
    )


def _next_entry(site: Site) -> Iterator[Any]:
    """Yields what the next entry of a table has."""
    entries = list(site.element.eContainer().entries)
    after = entries[(entries.index(site.element) + 1) % len(entries)]
    yield getattr(after, site.feature.name)


def _other_state(site: Site) -> Iterator[Any]:
    """Yields the target of another transition of the same machine, the next one."""
    if not site.value:
        return
    machine = site.element
    while machine.eClass.name != "StateMachine":
        machine = machine.eContainer()
    targets = sorted(
        {each.target for each in machine.eAllContents() if getattr(each, "event", 0) != 0} - {None}
    )
    at = targets.index(site.value)
    yield targets[(at + 1) % len(targets)]


def _no_text(site: Site) -> Iterator[Any]:
    if site.value:
        yield None


OPERATORS = (
    Operator(
        "sign",
        "negates a number, or no longer does",
        {"bridge.FieldAssignment": "conversions"},
        _negated,
    ),
    Operator(
        "factor",
        "multiplies a number by 1.1",
        {"bridge.FieldAssignment": "conversions"},
        _scaled_on,
    ),
    Operator(
        "offset",
        "adds 0.125 to a number",
        {"bridge.FieldAssignment": "conversions"},
        _moved_on,
    ),
    Operator(
        "figure",
        "multiplies an argument, a limit of a range or a quantity by 1.1",
        {
            "bridge.Conversion": "arguments",
            "bridge.Quantity": "value",
            "jaus.ScaleRange": "lower upper",
            "jaus.ValueRange": "lower upper",
            "ros.PrimitiveField": "minimum maximum",
            "ros.Parameter": "minimum maximum",
        },
        _times(1.1),
    ),
    Operator(
        "conversion",
        "leaves out a conversion",
        {"bridge.FieldAssignment": "conversions", "bridge.ListAssignment": "conversions"},
        _left_out,
    ),
    Operator(
        "member",
        "reads or fills the next member of the same kind",
        {"bridge.FieldAssignment": "source target"},
        _other_member,
    ),
    Operator(
        "assignment",
        "leaves out an assignment",
        {"bridge.AttributeMap": "toRos toJaus", "bridge.ListAssignment": "assignments"},
        _left_out,
    ),
    Operator(
        "constant",
        "sets another constant, default or parameter",
        {
            "bridge.ConstantAssignment": "value",
            "bridge.FieldAssignment": "defaultValue",
            "ros.Constant": "value",
            "ros.PrimitiveField": "defaultValue",
            "ros.Parameter": "value",
        },
        _other_constant,
    ),
    Operator(
        "unit",
        "states another unit of the same dimension",
        {
            "bridge.Conversion": "units",
            "bridge.Quantity": "units",
            "jaus.FixedField": "units",
            "jaus.Alternative": "units",
            "ros.Field": "units",
        },
        _other_unit,
    ),
    Operator(
        "frame",
        "states another frame, or none",
        {"jaus.Field": "frame", "ros.Field": "frame"},
        _other_where_stated,
    ),
    Operator(
        "table entry",
        "gives an entry the value of the next one",
        {"bridge.TableEntry": "jaus ros"},
        _next_entry,
    ),
    Operator(
        "table",
        "leaves out an entry",
        {"bridge.ValueTable": "entries", "jaus.ValueSet": "values"},
        _left_out,
    ),
    Operator(
        "number of a name",
        "adds one to the number of a value, a code or a bit",
        {
            "jaus.EnumeratedValue": "value",
            "jaus.MessageDef": "code",
            "jaus.SubField": "lowBit highBit",
        },
        _one_more,
    ),
    Operator(
        "order",
        "exchanges two neighbours of a list whose order counts",
        {
            "bridge.FieldAssignment": "conversions",
            "bridge.Conversion": "arguments",
            "jaus.Record": "fields",
            "jaus.Sequence": "fields",
            "jaus.Variant": "options",
            "ros.MessageType": "fields",
            "jaus.State": "transitions",
        },
        _exchanged,
    ),
    Operator(
        "rate",
        "halves a rate, and what else limits how often something is sent",
        {
            "bridge.Connection": "rate rateCap maxRate",
            "bridge.ReportSource": "rate",
            "jaus.ServiceConnection": "rate",
            "ros.Node": "frequency",
            "bridge.Bridge": "frequency",
        },
        _times(0.5),
    ),
    Operator(
        "time-out",
        "makes a time ten times as long, or leaves it out",
        {
            "bridge.Connection": "silenceTimeout freshness ageLimit",
            "bridge.AttributeMap": "freshness",
            "bridge.Stop": "silenceTimeout",
            "bridge.Join": "freshness",
            "bridge.ReportJoin": "freshness",
            "bridge.RosServiceConnection": "timeout",
            "bridge.RosActionConnection": "timeout",
            "jaus.ServiceConnection": "silenceTimeout",
            "jaus.Component": "controlTimeout eventTimeout",
        },
        _longer_or_left_out,
    ),
    Operator(
        "stop",
        "leaves out a value of a stop, or the stop",
        {
            "bridge.Connection": "safeValue",
            "bridge.AttributeMap": "stopRos stopJaus",
            "bridge.Stop": "values",
        },
        _left_out,
    ),
    Operator(
        "QoS",
        "states another quality of service, or doubles its figure",
        {"ros.QoSProfile": "reliability durability history liveliness"},
        _other,
    ),
    Operator(
        "figure of QoS",
        "doubles the depth or a time",
        {"ros.QoSProfile": "depth deadline lifespan leaseDuration"},
        _times(2),
    ),
    Operator(
        "policy",
        "states another policy, exchange or priority",
        {
            "bridge.FieldAssignment": "whenAbsent outOfRange",
            "bridge.ListAssignment": "whenAbsent",
            "bridge.AttributeMap": "whenStale",
            "bridge.Join": "whenStale",
            "bridge.ReportJoin": "whenStale",
            "bridge.Connection": "exchange outOfRange onSilence whenStale priority acknowledge",
            "bridge.RosServiceConnection": "outOfRange priority",
            "bridge.RosActionConnection": "outOfRange progress",
            "bridge.ReportSource": "exchange",
            "jaus.ServiceConnection": "exchange",
        },
        _other,
    ),
    Operator(
        "control",
        "turns what says who may command",
        {
            "bridge.Connection": "control",
            "bridge.RosServiceConnection": "control",
            "bridge.RosActionConnection": "control",
            "jaus.MessageDef": "isCommand moves",
        },
        _other,
    ),
    Operator(
        "authority",
        "halves an authority",
        {"jaus.Component": "authority defaultAuthority"},
        _times(0.5),
    ),
    Operator(
        "wiring",
        "leaves out a peer, a service, a topic or who is controlled",
        {
            "bridge.Connection": "peers topics",
            "bridge.RosServiceConnection": "peers",
            "bridge.RosActionConnection": "peers",
            "jaus.Component": "provides uses controls connections",
            "ros.Node": "publishers subscriptions",
        },
        _left_out,
    ),
    Operator(
        "topic",
        "names another topic",
        {"ros.TopicEndpoint": "topic", "bridge.Topic": "name"},
        _other_constant,
    ),
    Operator(
        "guard",
        "leaves out the guard of a transition",
        {"jaus.Transition": "guard"},
        _no_text,
    ),
    Operator(
        "target",
        "leads a transition to another state",
        {"jaus.Transition": "target"},
        _other_state,
    ),
    Operator(
        "behaviour",
        "leaves out a transition or an action",
        {
            "jaus.State": "transitions defaults entry exit",
            "jaus.Transition": "actions",
        },
        _left_out,
    ),
)
"""All operators; docs/reference/mutations.md has what they find in the examples."""
