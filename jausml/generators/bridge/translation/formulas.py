"""Expressions of the model as statements: long ones in several steps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH
from jausml.generators.common import runtime
from jausml.generators.python.expressions import python_condition, python_expression
from jausml.languages.expressions import Call, Conditional, Operation, Variable, operands_of

if TYPE_CHECKING:
    from jausml.generators.bridge.translation.body import Body
    from jausml.generators.python.expressions import PythonExpression
    from jausml.languages.expressions import Expression

# Room for what stands around an expression: brackets, indentation and the name of a function.
_AROUND = 20
# Characters of a part that needs no name of its own.
_SHORT = 16


@dataclass(frozen=True)
class ExpressionStatements:
    """Writes one expression.

    Args:
        body: Takes the statements of steps.
        sources: Python text of the variables.
    """

    body: Body
    sources: dict[str, str]

    def code(self, expression: Expression) -> str:
        """Returns the Python text of the expression; its steps become local variables."""
        if isinstance(expression, Conditional) and len(self._text(expression)) > self._room:
            return self._chosen(expression)
        return self._used(python_expression(self._shortened(expression), self.sources))

    @property
    def _room(self) -> int:
        return LINE_WIDTH - self.body.column - _AROUND

    def _used(self, written: PythonExpression) -> str:
        for name in written.functions:
            self.body.use(runtime.ARITHMETIC, name)
        return written.code

    def _chosen(self, expression: Conditional) -> str:
        """One of two values as statements, under a name."""
        name = self.body.local_names.claim("term")
        text = self._text(expression)
        if self.body.column + len(f"{name} = {text}") <= LINE_WIDTH:
            self.body.store(self._used(python_expression(expression, self.sources)), name)
            return name
        condition = self._shortened(expression.condition)
        test = self._used(python_condition(condition, self.sources))
        with self.body.inside(self.body.condition([test])):
            self.body.store(self.code(expression.then), name)
        with self.body.inside("else:"):
            self.body.store(self.code(expression.otherwise), name)
        return name

    def _shortened(self, expression: Expression) -> Expression:
        operands = operands_of(expression)
        if not operands or len(self._text(expression)) <= self._room:
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
        name = self.body.local_names.claim("term")
        self.body.store(self.code(operand), name)
        self.sources[name] = name
        return Variable(name)

    def _text(self, expression: Expression) -> str:
        return python_expression(expression, self.sources).code
