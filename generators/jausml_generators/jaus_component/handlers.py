"""Methods of a skeleton: what a component handles, answers and receives, one view for each.

In a simulated component a command is kept, and a report says what was kept. A Set and a Report
belong together by their names, as the standards have them (AS6009, AS6057): X and what is commanded
of X. ExecuteList belongs to ReportActiveElement.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from textwrap import indent
from typing import Any, TypeVar

from jausml.generation.artifact import MethodContract
from jausml.generation.errors import GenerationError
from jausml.generation.literals import clean, docstring, python_literal, sentence
from jausml.language.metamodel.classes import jaus
from jausml_generators.common.components import address_call, search_call
from jausml_generators.python import names
from jausml_generators.python.codec.classes import ContainerClass, VariableFieldClass
from jausml_generators.python.codec.members import (
    ArrayValue,
    ListValue,
    Member,
    PartValue,
    VariantValue,
)
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Fixed
from jausml_generators.python.package import laid_out
from jausml_generators.python.statements import call

GUARD_TEXTS = {
    "ANY": "from whoever sends it",
    "CONTROLLED": "from the controller",
    "READY": "from the controller while the component is Ready",
}
_BODY = 8


@dataclass(frozen=True)
class Method:
    """A method that the base calls and the user's class overrides.

    Attributes:
        simulation: What the base does in a simulated component; nothing where it cannot.
    """

    name: str
    parameters: tuple[tuple[str, str], ...]
    result: str
    documentation: str
    identity: str
    simulation: tuple[str, ...] = ()

    @property
    def signature(self) -> str:
        """Its first line."""
        parameters = ["self", *(f"{name}: {kind}" for name, kind in self.parameters)]
        return f"def {self.name}({', '.join(parameters)}) -> {self.result}:"

    @property
    def docstring(self) -> str:
        """Its docstring."""
        return docstring(self.documentation, _BODY)

    @property
    def default(self) -> tuple[str, ...]:
        """Statements of the base, for a method that is not implemented."""
        if self.simulation:
            return self.simulation
        *messages, (sender, _) = self.parameters
        what = "".join(f" {{{name}.NAME}}" for name, _ in messages)
        detail = f'f"{self.name}:{what} from {{{sender}}}"'
        # A counter of its own: the log tells one name at a time, and reports come often.
        name = "not_implemented" if messages else "silence_not_implemented"
        count = call("self.counters.count", f'"component.{name}"', detail)
        return (count, "return None") if self.result != "None" else (count,)

    @property
    def placeholder(self) -> str:
        """Statement of the skeleton: what the base does."""
        default = call(f"super().{self.name}", *(name for name, _ in self.parameters))
        return f"return {default}" if self.result != "None" else default

    @property
    def contract(self) -> MethodContract:
        """The contract with which the drift report compares the user's class."""
        body = indent(f"{self.docstring}\n{self.placeholder}", " " * _BODY)
        stub = f"    {self.signature}\n{body}\n"
        names = tuple(name for name, _ in self.parameters)
        return MethodContract(self.name, names, self.identity, laid_out(stub))


@dataclass(frozen=True)
class Handler:
    """An input message that is no query."""

    message: MessageView
    method: Method
    when: str

    @property
    def registration(self) -> str:
        """Statement of the constructor."""
        method, when = f"self.{self.method.name}", f"when={self.when}"
        return call("self.handle", self.message.class_name, method, when)


@dataclass(frozen=True)
class Answer:
    """A query and its report."""

    query: MessageView
    report: MessageView
    method: Method

    @property
    def registration(self) -> str:
        """Statement of the constructor."""
        names = (self.query.class_name, self.report.class_name, f"self.{self.method.name}")
        return call("self.provide", *names)


@dataclass(frozen=True)
class Peer:
    """Another component that this one controls or receives reports from.

    Attributes:
        control: Name of the attribute with the control session; empty when not controlled.
    """

    constant: str
    address: str
    name: str
    control: str


class Peers:
    """The other components that a component controls or receives reports from.

    Attributes:
        known: Those that are named, in order.
    """

    def __init__(self, component: jaus.Component) -> None:
        scope = names.Scope(frozenset(["CODE", "NAME"]))
        controlled = list(component.controls)
        every = (connection.provider for connection in component.connections)
        providers = [provider for provider in every if provider is not None]
        self.known: dict[jaus.Component, Peer] = {}
        for provider in dict.fromkeys([*controlled, *providers]):
            constant = scope.claim(names.constant_name(str(provider.name)))
            control = f"control_of_{constant.lower()}" if provider in controlled else ""
            self.known[provider] = Peer(
                constant, address_call(provider), clean(provider.name), control
            )

    def provider_of(self, connection: jaus.ServiceConnection) -> tuple[str, str]:
        """Returns the sender of the report of a connection, as an expression and for people."""
        if connection.search is not None:
            services = " and ".join(clean(service.name) for service in connection.search.services)
            return search_call(connection.search), f"a provider of {services}"
        if connection.provider is None:
            raise GenerationError(f"connection '{connection.name}' has no provider")
        peer = self.known[connection.provider]
        return f"self.{peer.constant}", peer.name


@dataclass(frozen=True)
class Received:
    """A report that a service connection brings."""

    connection: jaus.ServiceConnection
    query: MessageView
    report: MessageView
    provider: str
    method: Method
    silent: Method | None

    @property
    def is_found(self) -> bool:
        """Whether a search finds its sender."""
        return self.connection.search is not None

    @property
    def is_asked(self) -> bool:
        """Whether it is asked for once."""
        return bool(self.connection.exchange.name == "oneTime")

    @property
    def registration(self) -> str:
        """Statement of the constructor."""
        arguments = [
            self.provider,
            self._query(),
            self.report.class_name,
            f"self.{self.method.name}",
        ]
        if self.is_asked:
            return call("self.query_found" if self.is_found else "self.query", *arguments)
        if self.connection.exchange.name == "periodic":
            arguments.append(f"rate={python_literal(float(self.connection.rate))}")
        if self.silent:
            timeout = python_literal(float(self.connection.silenceTimeout))
            arguments.append(f"silence_timeout={timeout}")
            method = f"self.{self.silent.name}"
            callback = method if self.is_found else f"lambda: {method}({self.provider})"
            arguments.append(f"on_silence={callback}")
            if self.connection.whenSilent.name == "standby":
                arguments.append("stands_by=True")
        return call("self.subscribe_to_found" if self.is_found else "self.subscribe", *arguments)

    def _query(self) -> str:
        """Returns the query for all optional fields of the report."""
        wanted = self.report.body.presence_mask
        selectors = [
            member for member in self.query.body.members if member.jaus_name == "PresenceVector"
        ]
        arguments = tuple(f"{member.attribute}=0x{wanted:X}" for member in selectors)
        return call(self.query.class_name, *(arguments if wanted else ()))


def documented(element: jaus.NamedElement, otherwise: str) -> str:
    """Returns the documentation of an element, as a sentence."""
    return sentence(clean(element.documentation) or otherwise)


PartT = TypeVar("PartT", Handler, Answer)

_SET, _REPORT, _COMMANDED = "Set", "Report", "Commanded"
_BY_DEFINITION = {"ExecuteList": "ActiveElement"}


def simulated(
    handlers: Iterable[Handler], answers: Iterable[Answer]
) -> tuple[tuple[Handler, ...], tuple[Answer, ...]]:
    """Returns the methods of a component with the statements of a simulation."""
    answers = tuple(answers)
    reports = [answer.report for answer in answers]
    return (
        tuple(_with(handler, _kept(handler.message, reports)) for handler in handlers),
        tuple(_with(answer, (f"return {_reported(answer.report)}",)) for answer in answers),
    )


def _with(part: PartT, statements: tuple[str, ...]) -> PartT:
    return replace(part, method=replace(part.method, simulation=statements))


def _kept(message: MessageView, reports: Iterable[MessageView]) -> tuple[str, ...]:
    """Returns statements that keep the values of a command, one for each report of it."""
    wanted = _commanded(message)
    of_it = (report for report in reports if wanted and _quantity(report) == wanted)
    statements = tuple(filter(None, (_keep(message, report) for report in of_it)))
    return (*statements, "return None") if statements else ()


def _reported(report: MessageView) -> str:
    """Returns the expression of a report that says what was kept."""
    members = {member.attribute: _at_rest(report, member) for member in report.body.members}
    arguments = (f"{name}={value}" for name, value in members.items() if value)
    return call("self.simulation.report", call(report.class_name, *arguments))


def _commanded(message: MessageView) -> str:
    """Returns the quantity that a command sets, empty when it is not known."""
    name = message.jaus_name
    is_set = name.startswith(_SET)
    return name.removeprefix(_SET) if is_set else _BY_DEFINITION.get(name, "")


def _quantity(report: MessageView) -> str:
    return report.jaus_name.removeprefix(_REPORT).removeprefix(_COMMANDED)


def _keep(message: MessageView, report: MessageView) -> str:
    """Returns the statement for the members that both have alike, empty for none."""
    meanings = {member.attribute: _meaning(member.value) for member in message.body.members}
    alike = (
        member.attribute
        for member in report.body.members
        if not _is_stamp(member) and meanings.get(member.attribute) == _meaning(member.value)
    )
    arguments = [f"{attribute}=message.{attribute}" for attribute in alike]
    return call("self.simulation.keep", report.class_name, *arguments) if arguments else ""


def _at_rest(report: MessageView, member: Member) -> str:
    """Returns the value of an optional member at rest; empty where the class has it."""
    if _is_stamp(member):
        return f"{report.class_name}.TimeStamp.of(self.current_time)"
    if isinstance(member.value, Fixed) and not isinstance(member.value, Bits):
        return member.value.default if member.is_optional else ""
    return ""


def _is_stamp(member: Member) -> bool:
    return isinstance(member.value, Bits) and member.value.is_stamp


def _meaning(value: Any) -> Any:
    """Returns the layout and meaning of a value on the wire, without the names of classes."""
    match value:
        case Fixed() if not isinstance(value, Bits):
            return (value.format, value.python_type, value.scale, value.offset, value.listed)
        case PartValue(part=ContainerClass() as part):
            inner = (
                (member.attribute, member.bit, _meaning(member.value)) for member in part.members
            )
            return (part.presence_size, *inner)
        case PartValue(part=VariableFieldClass() as part):
            return tuple(
                (alternative.index, _meaning(alternative.value))
                for alternative in part.alternatives
            )
        case VariantValue():
            return (value.tag_format, *map(_meaning, value.options))
        case ListValue():
            return (value.count_format, value.upper, _meaning(value.element))
        case ArrayValue():
            return (value.dimensions, _meaning(value.element))
    return value
