"""Arithmetic expressions of attribute maps as Python expressions.

Python is written from the tree of an expression, never from its text.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from jausml.generation.literals import python_literal
from jausml.language.attributes.expressions import (
    COMPARISONS,
    Call,
    Conditional,
    Expression,
    Number,
    Operation,
    Variable,
    operands_of,
)
from jausml_generators.python.names import Scope
from jausml_generators.python.statements import Assign, If, Statement

_FUNCTIONS = {
    "sin": "sine",
    "cos": "cosine",
    "tan": "tangent",
    "asin": "arc_sine",
    "acos": "arc_cosine",
    "atan": "arc_tangent",
    "atan2": "direction",
    "sqrt": "root",
    "abs": "magnitude",
    "min": "least",
    "max": "greatest",
    "floor": "round_down",
    "ceil": "round_up",
    "round": "round_off",
    "sign": "sign",
    "hypot": "length",
    "fmod": "modulo",
    "remainder": "remainder",
    "isfinite": "is_finite",
}
_CALLED_OPERATORS = {"/": "divide", "^": "power"}
_TRUTHS = COMPARISONS | {"and", "or", "not"}
# How tightly an operator of Python binds what stands beside it.
_ATOM, _SIGNED, _PRODUCT, _SUM, _COMPARISON, _NOT, _AND, _OR, _CHOICE = range(9)
_BINDING = {"*": _PRODUCT, "+": _SUM, "-": _SUM, "and": _AND, "or": _OR}


def python_expression(expression: Expression, sources: Mapping[str, str]) -> str:
    """Returns the Python expression, in one line, that computes an expression as a `float`.

    Args:
        sources: Python for each variable, by name: a name, an attribute, an item or a call.
    """
    return _Writer(sources).number(expression, _CHOICE)


def python_condition(
    expression: Expression, sources: Mapping[str, str], *, is_joined: bool = False
) -> str:
    """Returns the Python expression that tells whether an expression differs from 0.

    Args:
        is_joined: Whether others stand beside it, joined by `and`.
    """
    return _Writer(sources).truth(expression, _NOT if is_joined else _CHOICE)


class _Writer:
    """Writes with as few parentheses as Python needs."""

    def __init__(self, sources: Mapping[str, str]) -> None:
        self._sources = sources

    def number(self, expression: Expression, binding: int) -> str:
        """Python for a number, in parentheses when it binds more loosely than asked for."""
        if isinstance(expression, Number):
            return self._literal(expression.value, binding)
        if isinstance(expression, Variable):
            return self._sources[expression.name]
        if isinstance(expression, Conditional):
            code = (
                f"{self.number(expression.then, _OR)} if {self.truth(expression.condition, _OR)}"
                f" else {self.number(expression.otherwise, _CHOICE)}"
            )
            return _within(code, _CHOICE, binding)
        if isinstance(expression, Call):
            call = self._call(_FUNCTIONS[expression.function], expression.arguments)
            return f"float({call})" if expression.function == "isfinite" else call
        if expression.sign in _TRUTHS:
            return f"float({self.truth(expression, _CHOICE)})"
        return self._operation(expression, binding)

    def truth(self, expression: Expression, binding: int) -> str:
        """Python for whether an expression differs from 0."""
        if isinstance(expression, Call) and expression.function == "isfinite":
            return self._call("is_finite", expression.arguments)
        if not isinstance(expression, Operation) or expression.sign not in _TRUTHS:
            return _within(f"{self.number(expression, _SUM)} != 0", _COMPARISON, binding)
        sign, operands = expression.sign, expression.operands
        if sign == "not":
            return _within(f"not {self.truth(operands[0], _NOT)}", _NOT, binding)
        if sign in COMPARISONS:
            left, right = (self.number(operand, _SUM) for operand in operands)
            return _within(f"{left} {sign} {right}", _COMPARISON, binding)
        own = _BINDING[sign]
        left, right = self.truth(operands[0], own), self.truth(operands[1], own - 1)
        return _within(f"{left} {sign} {right}", own, binding)

    def _operation(self, expression: Operation, binding: int) -> str:
        sign, operands = expression.sign, expression.operands
        if len(operands) == 1:
            return _within(f"-{self.number(operands[0], _SIGNED)}", _SIGNED, binding)
        if sign in _CALLED_OPERATORS:
            return self._call(_CALLED_OPERATORS[sign], operands)
        own = _BINDING[sign]
        left, right = self.number(operands[0], own), self.number(operands[1], own - 1)
        return _within(f"{left} {sign} {right}", own, binding)

    def _call(self, function: str, arguments: Sequence[Expression]) -> str:
        argument_text = ", ".join(self.number(argument, _CHOICE) for argument in arguments)
        return f"arithmetic.{function}({argument_text})"

    def _literal(self, value: float, binding: int) -> str:
        if not math.isfinite(value):
            return f'float("{value}")'
        return _within(python_literal(value), _SIGNED if value < 0 else _ATOM, binding)


def _within(code: str, own: int, binding: int) -> str:
    return f"({code})" if own > binding else code


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
        test = python_condition(condition, self.sources)
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
        """Returns an operand under a name of its own, if it can be computed before."""
        if not operands_of(operand) or len(self._text(operand)) <= _SHORT:
            return operand
        if not is_certain and "arithmetic." in self._text(operand):
            return operand
        name = self.names.claim("term")
        self.statements.append(Assign(name, self.code(operand)))
        self.sources[name] = name
        return Variable(name)

    def _text(self, expression: Expression) -> str:
        return python_expression(expression, self.sources)
