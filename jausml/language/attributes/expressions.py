"""Arithmetic expressions of attribute maps: read, evaluated and bounded, and never run as code."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence

from jausml.language.attributes import intervals as spans
from jausml.language.attributes.cursor import Language, LanguageError, Token, TokenCursor
from jausml.language.attributes.expression_tree import (
    FUNCTIONS,
    OPERATORS,
    Call,
    Conditional,
    Expression,
    Function,
    Number,
    Operation,
    Variable,
    occurrences,
    operands_of,
    operations,
    opposite,
    source_names,
    variables,
)
from jausml.language.attributes.intervals import Interval

LONGEST = 1000
"""Characters of an expression; more is none that a person wrote."""
DEEPEST = 60
"""Operations within each other; more could not be nested in generated code."""

COMPARISONS = frozenset({"<", "<=", ">", ">=", "==", "!="})
"""Operators that yield 1 or 0."""
CONSTANTS = {"pi": math.pi, "inf": math.inf, "nan": math.nan}
"""Numbers with a name; `nan` goes to the out-of-range policy of the target."""


class ExpressionError(LanguageError):
    """A text is no expression."""


_LANGUAGE = Language(
    noun="expression",
    tokens=re.compile(
        r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
        r"|(?P<name>[^\W\d]\w*(?:\[[0-9]+\])?(?:\.[^\W\d]\w*(?:\[[0-9]+\])?)*)"
        r"|`(?P<quoted>[^`]+)`"
        r"|(?P<sign><=|>=|==|!=|[-+*/^(),<>]))"
    ),
    error=ExpressionError,
    longest=LONGEST,
    deepest=DEEPEST,
)
_WORDS = {"and", "or", "not"}


_COMPARED_WITH_NAN = (
    "a comparison with nan says the same of all values; value != value holds for nan alone, and "
    "isfinite(value) for neither nan nor inf"
)


def parse_expression(text: str) -> Expression:
    """Returns the expression that a text describes."""
    return _Parser(text).whole()


class _Parser:
    def __init__(self, text: str) -> None:
        self._cursor = TokenCursor(text, _LANGUAGE)

    def whole(self) -> Expression:
        expression = self._any_of()
        self._cursor.expect_end()
        _check_depth(expression)
        return expression

    def _any_of(self) -> Expression:
        return self._joined(self._all_of, "or")

    def _all_of(self) -> Expression:
        return self._joined(self._negation, "and")

    def _negation(self) -> Expression:
        if self._cursor.take("not"):
            return Operation("not", (self._cursor.nested(self._negation),))
        left, column = self._sum(), self._cursor.token.column
        if sign := self._cursor.take(*COMPARISONS):
            left = Operation(sign, (left, self._sum()))
            if any(isinstance(side, Number) and math.isnan(side.value) for side in left.operands):
                raise ExpressionError(_COMPARED_WITH_NAN, column)
            if self._cursor.token.text in COMPARISONS:
                raise self._cursor.error("comparisons are joined by 'and' or 'or'")
        return left

    def _sum(self) -> Expression:
        return self._joined(self._product, "+", "-")

    def _product(self) -> Expression:
        return self._joined(self._signed, "*", "/")

    def _joined(self, operand: Callable[[], Expression], *signs: str) -> Expression:
        left = operand()
        while sign := self._cursor.take(*signs):
            left = Operation(sign, (left, operand()))
        return left

    def _signed(self) -> Expression:
        if not self._cursor.take("-"):
            return self._power()
        operand = self._cursor.nested(self._signed)
        return Number(-operand.value) if isinstance(operand, Number) else Operation("-", (operand,))

    def _power(self) -> Expression:
        base = self._single()
        return (
            Operation("^", (base, self._cursor.nested(self._signed)))
            if self._cursor.take("^")
            else base
        )

    def _single(self) -> Expression:
        cursor = self._cursor
        if cursor.take("("):
            return cursor.parenthesized(self._any_of)
        token = cursor.token
        if token.kind in {"sign", "end"} or (token.kind == "name" and token.text in _WORDS):
            raise cursor.error(f"a value is missing before {token}")
        cursor.advance()
        if token.kind == "number":
            return _number(token)
        if token.kind == "name":
            if cursor.take("("):
                return self._call(token)
            if token.text in CONSTANTS:
                return Number(CONSTANTS[token.text])
        return Variable(token.text, token.column)

    def _call(self, name: Token) -> Expression:
        if name.text != "if" and name.text not in FUNCTIONS:
            known = ", ".join(["if", *FUNCTIONS])
            raise ExpressionError(f"'{name.text}' is no function; there are {known}", name.column)
        arguments = [self._cursor.nested(self._any_of)]
        while self._cursor.take(","):
            arguments.append(self._cursor.nested(self._any_of))
        self._cursor.expect(")", f"the arguments of {name.text} do not end")
        fewest, most = (3, 3) if name.text == "if" else FUNCTIONS[name.text][2:]
        if not fewest <= len(arguments) <= most:
            number = str(fewest) if fewest == most else f"{fewest} to {most}"
            raise ExpressionError(
                f"{name.text} takes {number} arguments, not {len(arguments)}", name.column
            )
        if name.text == "if":
            return Conditional(*arguments)
        return Call(name.text, tuple(arguments))


def _number(token: Token) -> Number:
    value = float(token.text)
    if math.isinf(value):
        raise ExpressionError(f"{token.text} is too large a number", token.column)
    return Number(value)


def _check_depth(expression: Expression) -> None:
    """Refuses long chains: their operations are within each other too."""
    level: list[Expression] = [expression]
    for _ in range(DEEPEST):
        level = [inner for parent in level for inner in operands_of(parent)]
        if not level:
            return
    raise ExpressionError(f"more than {DEEPEST} operations within each other", 1)


__all__ = [
    "COMPARISONS",
    "CONSTANTS",
    "DEEPEST",
    "FUNCTIONS",
    "LONGEST",
    "Call",
    "Conditional",
    "EvaluationError",
    "Expression",
    "ExpressionError",
    "Number",
    "Operation",
    "Variable",
    "evaluate",
    "interval",
    "occurrences",
    "operands_of",
    "operations",
    "opposite",
    "parse_expression",
    "source_names",
    "variables",
]

_CONNECTIVES = {"and", "or", "not"}


class EvaluationError(ValueError):
    """An expression has no value for some values of its sources."""


def evaluate(expression: Expression, values: Mapping[str, float]) -> float:
    """Returns the value of an expression.

    Raises:
        EvaluationError: It has none there: it divides by zero, or a function is outside of its
            domain.
    """
    if isinstance(expression, Number):
        return expression.value
    if isinstance(expression, Variable):
        return float(values[expression.name])
    if isinstance(expression, Conditional):
        holds = evaluate(expression.condition, values) != 0.0
        return evaluate(expression.then if holds else expression.otherwise, values)
    operands = operands_of(expression)
    if isinstance(expression, Operation) and expression.sign in _CONNECTIVES:
        truths = (evaluate(operand, values) != 0.0 for operand in operands)
        if expression.sign == "not":
            return float(not next(truths))
        return float(all(truths) if expression.sign == "and" else any(truths))
    numbers = [evaluate(operand, values) for operand in operands]
    try:
        return float(_function_of(expression).compute(*numbers))
    except (ValueError, OverflowError, ZeroDivisionError):
        name = expression.function if isinstance(expression, Call) else expression.sign
        raise EvaluationError(f"{name} has no value for {', '.join(map(str, numbers))}") from None


def interval(expression: Expression, intervals: Mapping[str, Interval]) -> Interval | None:
    """Returns the least and greatest value of an expression; None when it never has one.

    The result is never narrower than the truth, but may be wider: a variable that stands in several
    places counts there as several.
    """
    bounds = _bound(expression, intervals)
    return None if spans.is_empty(bounds) else bounds


def _bound(expression: Expression, known: Mapping[str, Interval]) -> Interval:
    if isinstance(expression, Number):
        # What is not a number lies in no interval.
        value = expression.value
        return spans.EMPTY if math.isnan(value) else (value, value)
    if isinstance(expression, Variable):
        low, high = known[expression.name]
        return float(low), float(high)
    if isinstance(expression, Conditional):
        return _bound_choice(expression, known)
    operands = [_bound(operand, known) for operand in operands_of(expression)]
    if isinstance(expression, Operation) and expression.sign in _CONNECTIVES:
        return _bound_truth(expression.sign, operands)
    if any(map(spans.is_empty, operands)):
        return spans.EITHER if _is_verdict(expression) else spans.EMPTY
    return _function_of(expression).bound(*operands)


def _is_verdict(expression: Operation | Call) -> bool:
    """Whether the result is 1 or 0 also for what is not a number."""
    if isinstance(expression, Call):
        return expression.function == "isfinite"
    return expression.sign in COMPARISONS


def _bound_choice(expression: Conditional, known: Mapping[str, Interval]) -> Interval:
    condition = _bound(expression.condition, known)
    # What is not a number counts as true.
    verdict = spans.TRUE if spans.is_empty(condition) else spans.truth(condition)
    if verdict == spans.TRUE:
        return _bound(expression.then, known)
    if verdict == spans.FALSE:
        return _bound(expression.otherwise, known)
    return spans.hull(_bound(expression.then, known), _bound(expression.otherwise, known))


def _bound_truth(sign: str, operands: Sequence[Interval]) -> Interval:
    # An operand without a value may be one that is never asked, and not a number counts as true.
    truths = [
        spans.EITHER if spans.is_empty(operand) else spans.truth(operand) for operand in operands
    ]
    if sign == "not":
        return spans.inverse(truths[0])
    return spans.least(*truths) if sign == "and" else spans.greatest(*truths)


def _function_of(expression: Operation | Call) -> Function:
    if isinstance(expression, Call):
        return FUNCTIONS[expression.function]
    return OPERATORS[expression.sign, len(expression.operands)]
