"""Arithmetic expressions of attribute maps as Python expressions.

Python is written from the tree of an expression, never from its text.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeGuard

from jausml.generation.literals import LINE_WIDTH, python_literal
from jausml.language.attributes.expressions import (
    COMPARISONS,
    Call,
    Conditional,
    Expression,
    Number,
    Operation,
    Variable,
    operands_of,
    opposite,
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
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
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
        if _is_truth(expression):
            return f"float({self.truth(expression, _CHOICE)})"
        if isinstance(expression, Call):
            return self._call(_FUNCTIONS[expression.function], expression.arguments)
        return self._operation(expression, binding)

    def truth(self, expression: Expression, binding: int) -> str:
        """Python for whether an expression differs from 0."""
        if not _is_truth(expression):
            return _within(f"{self.number(expression, _SUM)} != 0", _COMPARISON, binding)
        if isinstance(expression, Call):
            return self._call("is_finite", expression.arguments)
        sign, operands = expression.sign, expression.operands
        if sign == "not":
            return self._untruth(operands[0], binding)
        if sign in COMPARISONS:
            if isinstance(operands[0], Number):
                sign, operands = _MIRRORED.get(sign, sign), operands[::-1]
            left, right = (self.number(operand, _SUM) for operand in operands)
            return _within(f"{left} {sign} {right}", _COMPARISON, binding)
        first, second = operands
        is_chain = isinstance(first, Operation) and first.sign == sign
        own = _BINDING[sign]
        code = f"{self.truth(first, own if is_chain else _NOT)} {sign} {self.truth(second, _NOT)}"
        return _within(code, own, binding)

    def _untruth(self, expression: Expression, binding: int) -> str:
        """Python for whether an expression is 0."""
        if not _is_truth(expression):
            return _within(f"{self.number(expression, _SUM)} == 0", _COMPARISON, binding)
        if isinstance(expression, Operation) and expression.sign in {"not", "==", "!="}:
            return self.truth(opposite(expression), binding)
        return _within(f"not {self.truth(expression, _NOT)}", _NOT, binding)

    def _operation(self, expression: Operation, binding: int) -> str:
        sign, operands = expression.sign, expression.operands
        if len(operands) == 1:
            inner = operands[0]
            if isinstance(inner, Operation) and inner.sign == "-" and len(inner.operands) == 1:
                return self.number(inner.operands[0], binding)
            return _within(f"-{self.number(inner, _SIGNED)}", _SIGNED, binding)
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


def _is_truth(expression: Expression) -> TypeGuard[Operation | Call]:
    if isinstance(expression, Call):
        return expression.function == "isfinite"
    return isinstance(expression, Operation) and expression.sign in _TRUTHS


def _within(code: str, own: int, binding: int) -> str:
    return f"({code})" if own > binding else code


# Characters of an expression that is read at a glance.
_LONG = 72
# How far the statements of a method are from the margin; those in loops are farther.
_MARGIN = " " * 8
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
        branches = []
        for value in (expression.then, expression.otherwise):
            branch = replace(self, statements=[])
            branch.statements.append(Assign(name, branch.code(value)))
            branches.append(tuple(branch.statements))
        text = self._text(replace(expression, condition=condition))
        is_line = all(len(branch) == 1 for branch in branches)
        if is_line and len(f"{_MARGIN}{name} = {text}") <= LINE_WIDTH:
            self.statements.append(Assign(name, text))
        else:
            self.statements.append(If(python_condition(condition, self.sources), *branches))
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
