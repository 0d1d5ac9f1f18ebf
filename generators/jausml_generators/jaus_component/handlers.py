"""Methods of a skeleton: what a component handles, answers and receives, one view for each."""

from __future__ import annotations

from dataclasses import dataclass
from textwrap import indent
from typing import TYPE_CHECKING

from jausml.generation.artifact import MethodContract
from jausml.generation.literals import clean, docstring, python_literal, sentence
from jausml_generators.python.package import laid_out
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import jaus
    from jausml_generators.python.codec.messages import MessageView

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
        """Statements of the base: nobody has implemented it."""
        if self.simulation:
            return self.simulation
        *messages, (sender, _) = self.parameters
        what = "".join(f" {{{name}.NAME}}" for name, _ in messages)
        detail = f'f"{self.name}:{what} from {{{sender}}}"'
        count = call("self.counters.count", '"component.not_implemented"', detail)
        return (count, "return None") if self.result != "None" else (count,)

    @property
    def placeholder(self) -> str:
        """Statement of the skeleton: what the base does."""
        default = call(f"super().{self.name}", *(name for name, _ in self.parameters))
        return f"return {default}" if self.result != "None" else default

    @property
    def contract(self) -> MethodContract:
        """What the drift report compares the user's class with."""
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
    def registration(self) -> str:
        """Statement of the constructor."""
        arguments = [
            self.provider,
            self._query(),
            self.report.class_name,
            f"self.{self.method.name}",
        ]
        is_found = self.connection.search is not None
        exchange = self.connection.exchange.name
        if exchange == "oneTime":
            return call("self.query_found" if is_found else "self.query", *arguments)
        if exchange == "periodic":
            arguments.append(f"rate={python_literal(float(self.connection.rate))}")
        if self.silent:
            timeout = python_literal(float(self.connection.silenceTimeout))
            arguments.append(f"silence_timeout={timeout}")
            method = f"self.{self.silent.name}"
            callback = method if is_found else f"lambda: {method}({self.provider})"
            arguments.append(f"on_silence={callback}")
        return call("self.subscribe_to_found" if is_found else "self.subscribe", *arguments)

    def _query(self) -> str:
        """Returns the query for all optional fields of the report."""
        wanted = self.report.body.presence_mask
        selectors = [m for m in self.query.body.members if m.jaus_name == "PresenceVector"]
        arguments = tuple(f"{member.attribute}=0x{wanted:X}" for member in selectors)
        return call(self.query.class_name, *(arguments if wanted else ()))


def documented(element: jaus.NamedElement, otherwise: str) -> str:
    """Returns what the model says of an element, as a sentence."""
    return sentence(clean(element.documentation) or otherwise)
