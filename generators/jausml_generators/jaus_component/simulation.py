"""What methods of a simulated component do: a command is kept, a report says what was kept.

A Set and a Report belong together by their names, as the standards have them (AS6009, AS6057): X
and what is commanded of X. ExecuteList belongs to ReportActiveElement.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from jausml_generators.jaus_component.handlers import Answer, Handler
from jausml_generators.python.codec.classes import ContainerClass, VariableFieldClass
from jausml_generators.python.codec.compounds import ArrayValue, ListValue, PartValue, VariantValue
from jausml_generators.python.codec.scalars import Bits, Fixed
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml_generators.python.codec.members import Member
    from jausml_generators.python.codec.messages import MessageView

PartT = TypeVar("PartT", Handler, Answer)

_SET, _REPORT, _COMMANDED = "Set", "Report", "Commanded"
_BY_DEFINITION = {"ExecuteList": "ActiveElement"}


def simulated(
    handlers: Iterable[Handler], answers: Iterable[Answer]
) -> tuple[tuple[Handler, ...], tuple[Answer, ...]]:
    """Returns the methods of a component with what a simulation does in them."""
    answers = tuple(answers)
    reports = [each.report for each in answers]
    return (
        tuple(_with(each, _kept(each.message, reports)) for each in handlers),
        tuple(_with(each, (f"return {_reported(each.report)}",)) for each in answers),
    )


def _with(part: PartT, statements: tuple[str, ...]) -> PartT:
    return replace(part, method=replace(part.method, simulation=statements))


def _kept(message: MessageView, reports: Iterable[MessageView]) -> tuple[str, ...]:
    """Returns statements that keep what a command says, one for each report of it."""
    wanted = _commanded(message)
    of_it = (each for each in reports if wanted and _quantity(each) == wanted)
    statements = tuple(filter(None, (_keep(message, each) for each in of_it)))
    return (*statements, "return None") if statements else ()


def _reported(report: MessageView) -> str:
    """Returns the expression of a report that says what was kept."""
    members = {each.attribute: _at_rest(report, each) for each in report.body.members}
    arguments = (f"{name}={value}" for name, value in members.items() if value)
    return call("self.simulation.report", call(report.class_name, *arguments))


def _commanded(message: MessageView) -> str:
    """Returns what a command sets, empty when that is not known."""
    name = message.jaus_name
    is_set = name.startswith(_SET)
    return name.removeprefix(_SET) if is_set else _BY_DEFINITION.get(name, "")


def _quantity(report: MessageView) -> str:
    return report.jaus_name.removeprefix(_REPORT).removeprefix(_COMMANDED)


def _keep(message: MessageView, report: MessageView) -> str:
    """Returns the statement for what both have and mean alike, empty when that is nothing."""
    told = {each.attribute: _meaning(each.value) for each in message.body.members}
    alike = (
        each.attribute
        for each in report.body.members
        if not _is_stamp(each) and told.get(each.attribute) == _meaning(each.value)
    )
    arguments = [f"{each}=message.{each}" for each in alike]
    return call("self.simulation.keep", report.class_name, *arguments) if arguments else ""


def _at_rest(report: MessageView, member: Member) -> str:
    """Returns what an optional member says at rest; empty where the class says it."""
    if _is_stamp(member):
        return f"{report.class_name}.TimeStamp.of(self.current_time)"
    if isinstance(member.value, Fixed) and not isinstance(member.value, Bits):
        return member.value.default if member.is_optional else ""
    return ""


def _is_stamp(member: Member) -> bool:
    return isinstance(member.value, Bits) and member.value.is_stamp


def _meaning(value: Any) -> Any:
    """Returns what a value is on the wire and means, without the names of classes."""
    match value:
        case Fixed() if not isinstance(value, Bits):
            return (value.format, value.python_type, value.scale, value.offset, value.listed)
        case PartValue(part=ContainerClass() as part):
            inner = ((each.attribute, each.bit, _meaning(each.value)) for each in part.members)
            return (part.presence_size, *inner)
        case PartValue(part=VariableFieldClass() as part):
            return tuple((each.index, _meaning(each.value)) for each in part.alternatives)
        case VariantValue():
            return (value.tag_format, *map(_meaning, value.options))
        case ListValue():
            return (value.count_format, value.upper, _meaning(value.element))
        case ArrayValue():
            return (value.dimensions, _meaning(value.element))
    return value
