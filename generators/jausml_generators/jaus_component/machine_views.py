"""View of a state machine, its methods and its events, for templates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.docstrings import clean, docstring
from jausml.generation.literals import python_string
from jausml_generators.jaus_component.diagrams import diagram
from jausml_generators.jaus_component.handlers import Method
from jausml_generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from jausml.language.semantics.inherited_machines import Machine

_BODY = 8


@dataclass(frozen=True)
class MachineMethod(Method):
    """A guard or an action; the base does nothing but count that nobody has written it."""

    @property
    def default(self) -> tuple[str, ...]:
        """Statements of the base."""
        detail = python_string(self.name)
        if self.parameters:
            detail = f'f"{self.name}: {{message!r}} of {{sender}}"'
        count = call("self.counters.count", '"component.not_implemented"', detail)
        result = {"None": (), "bool": ("return False",)}.get(self.result, ("return None",))
        return (count, *result)


@dataclass(frozen=True)
class EventView:
    """An internal event of the component's services."""

    method: str
    name: str
    documentation: str

    @property
    def docstring(self) -> str:
        """Docstring of the method."""
        further = ("Callable from any thread.",)
        return docstring(self.documentation, _BODY, further)

    @property
    def statement(self) -> str:
        """Body of the method."""
        return call("self.raise_event", python_string(self.name))


@dataclass(frozen=True)
class MachineView:
    """A state machine.

    Attributes:
        ways: Steps over each transition, as expressions, for the generated test.
    """

    machine: Machine
    attribute: str
    table: str
    displays: tuple[str, ...]
    ways: tuple[str, ...]

    @property
    def name(self) -> str:
        """Its name in the model, clean."""
        return clean(self.machine.name)

    @property
    def service(self) -> str:
        """Name of the service that has it, the inherited one of several, clean."""
        return clean(self.machine.service_name)

    @property
    def registration(self) -> str:
        """Statement of the constructor."""
        arguments = [python_string(self.name), f"self.{self.table}()"]
        if self.machine.extends_core:
            arguments.append("extends_core=True")
        return f"self.{self.attribute} = {call('self.add_machine', *arguments)}"

    @property
    def docstring(self) -> str:
        """Docstring of the method that returns the states."""
        text = f"Return the states of {self.name} of {self.service}, and what happens in them."
        return docstring(text, _BODY)

    @property
    def diagram(self) -> str:
        """The machine as a state diagram."""
        return diagram(self.machine)

    @property
    def ways_constant(self) -> str:
        """Name of the constant of the generated test."""
        return f"WAYS_OF_{self.attribute.upper()}"

    @property
    def ways_text(self) -> str:
        """Assignment of the ways in the generated test."""
        return f"{self.ways_constant}: _Ways = {tuple_of(*self.ways)}"

    @property
    def test_signature(self) -> str:
        """First lines of the generated test of the ways."""
        name = f"test_{self.attribute}_goes_as_modelled"
        return (
            f'@pytest.mark.parametrize("way", {self.ways_constant})\n'
            f"def {name}(way: tuple[tuple[str, int, str], ...]) -> None:"
        )

    @property
    def states(self) -> str:
        """Statement that returns the states."""
        return f"return {tuple_of(*self.displays)}"
