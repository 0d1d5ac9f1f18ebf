"""Translations as statements of Python.

Text of the model enters them only as literals, and as names that were found in the model's types.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from jausml.generation.literals import python_literal, python_string
from jausml.language.attributes.expressions import occurrences
from jausml.language.semantics.conversions.octets import ReverseRows
from jausml_generators.bridge.translation import expressions as values
from jausml_generators.bridge.translation import places
from jausml_generators.bridge.translation.expressions import Constant, Expression, Limit, New
from jausml_generators.bridge.translation.octet_lists import octet_limit
from jausml_generators.bridge.translation.places import Condition, Local, Place
from jausml_generators.bridge.translation.steps import (
    Append,
    Choose,
    Each,
    Keep,
    Let,
    Require,
    Step,
    WhereKept,
    Write,
)
from jausml_generators.python.expressions import FormulaPrinter, python_condition
from jausml_generators.python.names import Scope
from jausml_generators.python.statements import (
    Assign,
    Do,
    For,
    If,
    Raise,
    Statement,
    call,
    rendered,
)

# Functions and modules that the module of a bridge imports; no local hides them.
IMPORTED = frozenset(
    {"arithmetic", "by_name", "conversions", "octets", "set_quaternion", "set_time"}
)
OWN_NAMES = IMPORTED | {"self", "source", "target"}
_CASTS = {values.REAL: "float", values.BOOLEAN: "bool", values.OCTETS: "bytes"}
# Characters of a value that may stand in an authored expression without a name of its own.
_SHORT = 40


def printed(steps: Iterable[Step], parameters: Iterable[str] = ()) -> tuple[str, ...]:
    """Returns the lines of a translation."""
    printer = _Printer(Scope(OWN_NAMES | frozenset(parameters)), {})
    return tuple(rendered(printer.statements(steps)))


def place_text(place: Place) -> str:
    """Returns a place in a message that has a name."""
    return _Printer(Scope(), {}).place(place)


def condition_text(condition: Condition) -> str:
    """Returns a condition about a message that has a name."""
    return _Printer(Scope(), {}).holds(condition)


def expression_text(value: Expression) -> str:
    """Returns an expression without variables, such as a constant or a new object."""
    return _Printer(Scope(), {}).text(value)


def literal(constant: Constant) -> str:
    """Returns a constant as Python text."""
    value = constant.value
    return python_string(value) if isinstance(value, str) else python_literal(value)


class _Printer:
    """Prints the steps of one method, whose blocks share names and variables."""

    def __init__(self, names: Scope, locals_: dict[Local, str]) -> None:
        self._names = names
        self._locals = locals_
        self._statements: list[Statement] = []

    # -- steps -----------------------------------------------------------------------------------

    def statements(self, steps: Iterable[Step]) -> list[Statement]:
        """Returns the statements of steps."""
        outer, self._statements = self._statements, []
        for step in steps:
            self._step(step)
        statements, self._statements = self._statements, outer
        return statements

    def _step(self, step: Step) -> None:
        match step:
            case Let(locals=variables, value=value):
                text = self.text(value)
                self._statements.append(Assign(", ".join(map(self._claim, variables)), text))
            case Write():
                self._write(step)
            case Keep(name=name, value=value):
                self._statements.append(Assign(f"self.{name}", self.text(value)))
            case Append(place=place, value=value):
                self._statements.append(Do(call(f"{self.place(place)}.append", self.text(value))))
            case Require(condition=condition, error=error, texts=texts):
                refusal = Raise(call(error, *map(python_string, texts)))
                self._statements.append(If(self.fails(condition), (refusal,)))
            case Choose(conditions=alternatives, steps=inner):
                self._choose(self._any(alternatives), inner)
            case WhereKept(name=name, steps=inner):
                self._choose(f"self.{name} is not None", inner)
            case Each():
                self._each(step)

    def _choose(self, test: str, steps: Sequence[Step]) -> None:
        self._statements.append(If(test, tuple(self.statements(steps))))

    def _write(self, step: Write) -> None:
        place, text = self.place(step.place), self.text(step.value)
        if step.value.kind in {values.QUATERNION, values.TIME}:
            self._statements.append(Do(call(f"set_{step.value.kind}", place, text)))
        else:
            self._statements.append(Assign(place, text, step.remark))

    def _claim(self, local: Local) -> str:
        if local not in self._locals:
            self._locals[local] = self._names.claim(local.hint)
        return self._locals[local]

    # -- lists -----------------------------------------------------------------------------------

    def _each(self, step: Each) -> None:
        limit = octet_limit(step)
        if limit is not None:
            self._statements.append(Assign(self.place(step.place), self._octets(step, limit)))
            return
        items = self.text(step.items)
        item, index = self._claim(step.item), self._claim(step.index)
        variables = f"{index}, {item}" if step.needs_index else item
        through = call("enumerate", items) if step.needs_index else items
        place = self.place(step.place)
        element = self._single(step)
        if element is not None:
            comprehension = f"[{element} for {variables} in {through}]"
            self._statements.append(
                Assign(place, call("list", through) if element == item else comprehension)
            )
            return
        self._loop(step, variables, through, place)

    def _octets(self, step: Each, limit: Limit) -> str:
        """Elements that are octets, by a conversion of the octet alone."""
        conversion = limit.value
        name = conversion.name if isinstance(conversion, values.Convert) else ""
        record = [step.octets.record] if step.octets and step.octets.record else []
        return call(
            "octets.each",
            ".".join(filter(None, ["self", limit.owner, limit.policy])),
            python_string(limit.path),
            f"conversions.{name}",
            self.text(step.items),
            *map(self.text, limit.bounds),
            *record,
        )

    def _single(self, step: Each) -> str | None:
        """Returns the element as one expression; None where it takes statements."""
        if len(step.steps) != 1 or step.new is not None:
            return None
        (only,) = step.steps
        if not isinstance(only, Write) or only.place != Place(step.element):
            return None
        value = only.value
        is_dropped = isinstance(value, Limit) and value.drops_field
        is_alternative = isinstance(value, New) and not value.is_spread
        if is_dropped or is_alternative or value.kind in {values.QUATERNION, values.TIME}:
            return None
        # On trial: a comprehension has no room for a statement that the element needs before.
        trial = _Printer(self._names.copy(), dict(self._locals))
        text = trial.text(value)
        return None if trial._statements else text

    def _loop(self, step: Each, variables: str, through: str, place: str) -> None:
        element = self._claim(step.element)
        body = self.statements(step.steps)
        if step.new is not None:
            body.insert(0, Assign(element, self.text(step.new)))
        filled = place
        # A list of ROS is checked when it is assigned, so it is filled under another name.
        if step.starts_empty and step.is_assigned_at_end:
            filled = self._names.claim("elements")
        if step.starts_empty:
            self._statements.append(Assign(filled, "[]"))
        body.append(Do(call(f"{filled}.append", element)))
        self._statements.append(For(variables, through, tuple(body)))
        if filled != place:
            self._statements.append(Assign(place, filled))

    # -- places and conditions -------------------------------------------------------------------

    def place(self, place: Place) -> str:
        """Returns a place."""
        root = place.root if isinstance(place.root, str) else self._claim(place.root)
        steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in place.steps)
        return root + "".join(steps)

    def _any(self, alternatives: Sequence[Sequence[Condition]]) -> str:
        """Returns the test that all conditions of one alternative hold."""
        tests = [self._all(conditions) for conditions in alternatives]
        if len(tests) == 1:
            return tests[0]
        return " or ".join(f"({test})" if " and " in test else test for test in tests)

    def _all(self, conditions: Sequence[Condition]) -> str:
        """Returns the test that conditions hold."""
        are_several = len(conditions) > 1
        return " and ".join(
            self.holds(condition, is_joined=are_several) for condition in conditions
        )

    def holds(self, condition: Condition, *, is_joined: bool = False) -> str:
        """Returns the test that a condition holds, which may be joined to others by `and`."""
        return self._test(condition, is_joined=is_joined)[0]

    def fails(self, condition: Condition) -> str:
        """Returns the test that a condition does not hold."""
        return self._test(condition)[1]

    def _test(self, condition: Condition, *, is_joined: bool = False) -> tuple[str, str]:
        at = self.place(condition.place)
        match condition:
            case places.There():
                return f"{at} is not None", f"{at} is None"
            case places.Longer(than=0):
                return at, f"not {at}"
            case places.Longer(than=than):
                return f"len({at}) > {than}", f"len({at}) <= {than}"
            case places.Chosen(index=index):
                return f"{at}.index == {index}", f"{at}.index != {index}"
            case places.IsOption(class_name=name):
                return f"isinstance({at}, {name})", f"not isinstance({at}, {name})"
            case places.Equal(number=number):
                return f"{at} == {number}", f"{at} != {number}"
            case places.AsLongAs(names=names):
                return f"len({at}) >= len({names})", f"len({at}) < len({names})"
            case places.HasValue(marker=marker, operands=operands):
                operand_texts = {
                    name: self.text(values.marker_value(operand)) for name, operand in operands
                }
                holds = python_condition(condition.condition, operand_texts, is_joined=is_joined)
                return holds, python_condition(marker, operand_texts)

    # -- expressions -----------------------------------------------------------------------------

    def text(self, value: Expression) -> str:  # noqa: C901 - one for each kind
        """Returns an expression; values that it needs first become statements."""
        match value:
            case Constant():
                return literal(value)
            case values.Read(place=place):
                return self.place(place)
            case values.Setting(name=name):
                return f"self.{name}"
            case values.Negative(value=inner):
                return f"-{self.text(inner)}"
            case values.Now():
                return "self.now()"
            case values.Cast(value=inner, kind=kind):
                return call(_CASTS[kind], self.text(inner))
            case values.Length(of=place):
                return call("len", self.place(place))
            case values.Convert():
                return self._convert(value)
            case values.LookUp(key=key, table=table):
                return call("conversions.look_up", self.text(key), table)
            case Limit():
                return self._limit(value)
            case values.Ranges(ranges=ranges):
                return repr(ranges)
            case values.Authored():
                return self._authored(value)
            case values.UserCall(method=method, inputs=inputs):
                return call(f"self.{method}", *map(self.text, inputs))
            case values.Either(conditions=conditions, value=inner, otherwise=otherwise):
                test = self._all(conditions)
                return f"{self.text(inner)} if {test} else {self.text(otherwise)}"
            case New(class_name=name, parts=parts, is_spread=is_spread):
                texts = map(self.text, parts)
                return call(name, *(f"*{text}" if is_spread else text for text in texts))
            case values.NewList(element=element, count=count):
                if isinstance(element, New):
                    return f"[{self.text(element)} for _ in range({count})]"
                return f"[{literal(element)}] * {count}" if element is not None else "[]"
            case values.IfKept(kept=kept, made=value):
                return f"None if {self.text(kept)} is None else {self.text(value)}"
            case values.Translate(method=method, message=message):
                return call(f"self.{method}", self.text(message))
            case values.Decode(class_name=name, data=data):
                return call(f"{name}.decode", self.text(data))
            case values.Encode(message=message):
                return call(f"{self.text(message)}.encode")
            case values.ByName(names=names, keys=keys, items=items, needed=needed, owner=owner):
                function = f"self.{owner}.by_name" if owner else "by_name"
                arguments = [names, self.text(keys), self.text(items)]
                return call(function, *arguments, *([python_string(needed)] if needed else []))
            case values.FirstOf(items=items, names=names):
                return f"{self.text(items)}[: len({names})]"
            case values.NamesOf(names=names, items=place):
                return f"list({names}[: len({self.place(place)})])"

    def _convert(self, value: values.Convert) -> str:
        arguments = [*map(self.text, (*value.inputs, *value.arguments))]
        if value.near is not None:
            arguments.append(f"near={self.text(value.near)}")
        if value.name == ReverseRows.name:
            return call("octets.reverse_rows", *arguments)
        return call(f"conversions.{value.name}", *arguments)

    def _limit(self, value: Limit) -> str:
        function = ".".join(filter(None, ["self", value.owner, value.policy, value.how]))
        arguments = [python_string(value.path), self.text(value.value)]
        return call(function, *arguments, *map(self.text, value.bounds))

    def _authored(self, value: values.Authored) -> str:
        names = dict(value.operands)
        # A name for what is long or used more than once, and no statement for what is neither.
        times = Counter(id(names[occurrence.name]) for occurrence in occurrences(value.expression))
        texts: dict[int, str] = {}
        for operand in names.values():
            if id(operand) in texts:
                continue
            text = self.text(operand.value)
            is_formula = isinstance(operand.value, values.Authored)
            is_plain = not operand.is_computed or (times[id(operand)] == 1 and not is_formula)
            if len(text) > _SHORT or not is_plain:
                local = self._names.claim(operand.hint)
                self._statements.append(Assign(local, text))
                text = local
            texts[id(operand)] = text
        sources = {name: texts[id(operand)] for name, operand in names.items()}
        return FormulaPrinter(self._statements, self._names, sources).code(value.expression)
