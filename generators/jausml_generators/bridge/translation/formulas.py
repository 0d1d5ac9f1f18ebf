"""Expressions of the model as statements: long ones in several steps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.language.attributes.expressions import (
    Call,
    Conditional,
    Operation,
    Variable,
    operands_of,
)
from jausml_generators.python.expressions import python_condition, python_expression
from jausml_generators.python.statements import Assign, If

if TYPE_CHECKING:
    from jausml.language.attributes.expressions import Expression
    from jausml_generators.python.names import Scope
    from jausml_generators.python.statements import Statement

# Characters of an expression that is read at a glance.
_LONG = 72
# Characters of a part that needs no name of its own.
_SHORT = 48


@dataclass(frozen=True)
class FormulaPrinter:
    """Writes one expression."""

    statements: list[Statement]
    names: Scope
    sources: dict[str, str]

    def code(self, expression: Expression) -> str:
        """Returns the Python text of the expression; its steps become local variables."""
        if isinstance(expression, Conditional) and len(self._text(expression)) > _LONG:
            return self._chosen(expression)
        return self._text(self._shortened(expression))

    def _chosen(self, expression: Conditional) -> str:
        """One of two values as statements, under a name."""
        name = self.names.claim("term")
        condition = self._shortened(expression.condition)
        test = python_condition(condition, self.sources).code
        branches = []
        for value in (expression.then, expression.otherwise):
            branch = replace(self, statements=[])
            branch.statements.append(Assign(name, branch.code(value)))
            branches.append(tuple(branch.statements))
        self.statements.append(If(test, *branches))
        return name

    def _shortened(self, expression: Expression) -> Expression:
        operands = operands_of(expression)
        if not operands or len(self._text(expression)) <= _LONG:
            return expression
        # What stands behind a condition may have no value where the condition does not hold.
        first_only = isinstance(expression, Operation) and expression.sign in {"and", "or"}
        shorter = tuple(
            self._step(operand, is_certain=not first_only or position == 0)
            for position, operand in enumerate(operands)
        )
        if isinstance(expression, Operation):
            return replace(expression, operands=shorter)
        if isinstance(expression, Call):
            return replace(expression, arguments=shorter)
        return expression

    def _step(self, operand: Expression, *, is_certain: bool) -> Expression:
        """An operand under a name of its own, if it can be computed before."""
        if not operands_of(operand) or len(self._text(operand)) <= _SHORT:
            return operand
        if not is_certain and python_expression(operand, self.sources).functions:
            return operand
        name = self.names.claim("term")
        self.statements.append(Assign(name, self.code(operand)))
        self.sources[name] = name
        return Variable(name)

    def _text(self, expression: Expression) -> str:
        return python_expression(expression, self.sources).code
