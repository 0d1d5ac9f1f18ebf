"""Expressions of readable translations on local variables instead of objects."""

from __future__ import annotations

import ast
import copy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.conversion import QUATERNION
from jausml.language.semantics.conversions.numbers import Clamp
from jausml.language.semantics.paths.attributes import TIME_STAMP
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.limits import limit_call
from jausml_generators.bridge.flat.texts import limit_variable, text_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml_generators.bridge.flat.limits import LimitCall
    from jausml_generators.bridge.flat.protocols import Octets, SequenceReading

_BUILTINS = frozenset({"bool", "bytes", "float", "int", "len", "list", "round"})
_FUNCTIONS = frozenset({"by_name"})
_MODULES = frozenset({"arithmetic", "conversions", "math", "octets", "rotations", "stamps"})
_ERRORS = frozenset({"AbsentFieldError", "ConversionError"})
LIMITED = "limited"
"""Variable of what is limited within an expression."""


class SourceValues(Protocol):
    """The values of the source message as expressions ask for them."""

    def expression(self, path: str) -> ast.expr:
        """Returns the expression of a value that stands alone or is an argument.

        Raises:
            NotFlatError: The path leads to an object that has none.
        """

    def presence(self, path: str) -> ast.expr:
        """Returns an expression that is None where a value is absent."""

    def stamp_bits(self, path: str) -> ast.expr:
        """Returns the expression of the bits of a TimeStamp of JAUS."""

    def parts(self, path: str, names: tuple[str, ...]) -> list[ast.expr]:
        """Returns the expressions of the fields of an object."""

    def chosen(self, path: str, class_name: str) -> ast.expr:
        """Returns the condition that an option of a variant was sent."""

    def count(self, path: str) -> ast.expr:
        """Returns the expression of the number of elements of a list."""

    def elements(self, path: str) -> tuple[SequenceReading, SourceValues]:
        """Returns what reads a list, and the values of an element."""

    def inside(self, path: str) -> SourceValues:
        """Returns the values of a part or of an element of a list."""


@dataclass
class Names:
    """Names that expressions know.

    Attributes:
        owner: Attribute of the bridge that is the connection.
        attributes: Names of attributes of the bridge, in the order in which they are asked for.
        variables: Names of local variables, parameters and constants of the module.
        constants: Those constants of the module that were used.
        roots: What stands for each object whose values are read, by its name.
        limits: The limits of the connection that are asked, each a key.
        slices: The first elements of lists, by name: the list, and the variable of their number.
        octets: Lists of octets by the name of the variable that has them.
    """

    owner: str
    attributes: list[str]
    variables: set[str]
    module: frozenset[str] = frozenset()
    constants: list[str] = field(default_factory=list)
    roots: dict[str, SourceValues] = field(default_factory=dict)
    limits: dict[str, None] = field(default_factory=dict)
    slices: dict[str, tuple[ast.expr, str]] = field(default_factory=dict)
    octets: dict[str, Octets] = field(default_factory=dict)

    def attribute(self, name: str) -> ast.expr:
        """Returns what stands for an attribute of the bridge until its name is known."""
        return _named(placeholder(self.attributes.index(name)))


def placeholder(index: int) -> str:
    """Returns what stands for an attribute of the bridge until its name is known."""
    return f"attribute_{index}__"


def lowered(expression: ast.expr, names: Names) -> ast.expr:
    """Returns an expression on local variables.

    Args:
        expression: One of a readable translation; it is not changed.
        names: The names that it may use.

    Raises:
        NotFlatError: It needs objects.
    """
    found = _Lowering(names).visit(copy.deepcopy(expression))
    if not isinstance(found, ast.expr):
        raise NotFlatError("an expression has no value")
    return found


def chain_of(node: ast.expr) -> tuple[str, str]:
    """Returns root and path of `root.a.b[2].c`; an empty root for other expressions."""
    steps: list[str] = []
    while True:
        if isinstance(node, ast.Attribute):
            steps.append(f".{node.attr}")
            node = node.value
        elif isinstance(node, ast.Subscript) and _index(node.slice) is not None:
            steps.append(f"[{_index(node.slice)}]")
            node = node.value
        elif isinstance(node, ast.Name):
            return node.id, "".join(reversed(steps)).removeprefix(".")
        else:
            return "", ""


def _index(node: ast.expr) -> int | None:
    if isinstance(node, ast.Constant) and type(node.value) is int:
        return node.value
    return None


def _named(name: str) -> ast.expr:
    return ast.Name(name, ast.Load())


def _call(function: str, *arguments: ast.expr) -> ast.expr:
    module, _, name = function.rpartition(".")
    callee = ast.Attribute(_named(module), name, ast.Load()) if module else _named(name)
    return ast.Call(callee, list(arguments), [])


class _Lowering(ast.NodeTransformer):
    """Puts local variables in the place of the values of objects."""

    def __init__(self, names: Names) -> None:
        self._names = names

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        """Tests whether a value is there."""
        root, path = chain_of(node.left)
        is_none = isinstance(node.ops[0], (ast.Is, ast.IsNot)) and len(node.ops) == 1
        if is_none and root in self._names.roots:
            node.left = self._names.roots[root].presence(path)
            return node
        return self.generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Values of the source, and attributes of the bridge."""
        return self._chain(node)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        """Elements of arrays of the source."""
        return self._chain(node)

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Local variables, and what a module may know."""
        names = self._names
        if node.id in names.roots:
            return names.roots[node.id].expression("")
        if node.id in names.module and node.id not in names.constants:
            names.constants.append(node.id)
        known = names.variables | names.module | _BUILTINS | _ERRORS | _MODULES | _FUNCTIONS
        if node.id not in known:
            raise NotFlatError(f"{node.id} is an object")
        return node

    def _chain(self, node: ast.Attribute | ast.Subscript) -> ast.AST:
        root, path = chain_of(node)
        if root in self._names.roots:
            return self._names.roots[root].expression(path)
        if root == "self":
            return self._of_bridge(node, path)
        return self.generic_visit(node)

    def _of_bridge(self, node: ast.expr, path: str) -> ast.expr:
        first, _, rest = path.partition(".")
        if first == self._names.owner:
            # A limit of something else than a range: it is called whatever the value is.
            policy, dot, method = rest.partition(".")
            self._names.limits.setdefault(policy)
            return ast.parse(f"{limit_variable(policy)}{dot}{method}", mode="eval").body
        if rest:
            raise NotFlatError(f"self.{path} is an object of the bridge")
        if not isinstance(node, ast.Attribute):
            raise NotFlatError(f"self.{path} is an object of the bridge")
        return self._names.attribute(first)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Calls: conversions without objects, and those that are no more than arithmetic."""
        limit = limit_call(node, self._names.owner)
        if limit is not None and limit.is_range:
            return self._limited(limit)
        if ast.unparse(node.func) == f"self.{self._names.owner}.{Clamp.name}.within":
            return self._within(*node.args)
        module, function = chain_of(node.func)
        root, path = chain_of(node.args[0]) if node.args else ("", "")
        if root in self._names.roots and module == "isinstance":
            return self._names.roots[root].chosen(path, ast.unparse(node.args[1]))
        if root in self._names.slices and module == "len":
            return _named(self._names.slices[root][1])
        if root in self._names.roots and module == "len":
            return self._names.roots[root].count(path)
        if module == "conversions":
            known = CONVERSIONS.get(function)
            if known is not None and known.inputs == (TIME_STAMP,):
                return self._time_of_stamp(node)
            node.args = [self._visited(each) for each in node.args]
            for keyword in node.keywords:
                keyword.value = self._visited(keyword.value)
            return _inlined(function, node)
        if module == "arithmetic":
            node.args = [self._visited(each) for each in node.args]
            return _inlined_arithmetic(function, node)
        return self.generic_visit(node)

    def _limited(self, limit: LimitCall) -> ast.expr:
        """A limit within an expression as a comparison, as for those that stand alone."""
        self._names.limits.setdefault(limit.policy)
        given = text_of(self._visited(limit.value))
        name = given if given.isidentifier() else LIMITED
        test = limit.test(given if given.isidentifier() else f"({LIMITED} := {given})")
        text = f"{limit.fitting(name)} if {test} else {limit.outside(name)}"
        return ast.parse(text, mode="eval").body

    def _within(self, field: ast.expr, value: ast.expr, *ends: ast.expr) -> ast.expr:
        """What a map limits on purpose as a comparison: the connection is asked for the others."""
        self._names.limits.setdefault(Clamp.name)
        given, *found = (text_of(self._visited(each)) for each in (value, *ends))
        minimum, maximum = found
        name = given if given.isidentifier() else LIMITED
        tested = given if given.isidentifier() else f"({LIMITED} := {given})"
        arguments = ", ".join((text_of(field), name, minimum, maximum))
        outside = f"{limit_variable(Clamp.name)}.within({arguments})"
        text = f"{name} if {minimum} <= {tested} <= {maximum} else {outside}"
        return ast.parse(text, mode="eval").body

    def _visited(self, node: ast.expr) -> ast.expr:
        found = self.visit(node)
        if not isinstance(found, ast.expr):
            raise NotFlatError("an argument has no value")
        return found

    def _time_of_stamp(self, node: ast.Call) -> ast.expr:
        root, path = chain_of(node.args[0])
        if root not in self._names.roots:
            return self._visited_call(node)
        (near,) = node.keywords
        bits = self._names.roots[root].stamp_bits(path)
        return _call("stamps.time_of", bits, self._visited(near.value))

    def _visited_call(self, node: ast.Call) -> ast.expr:
        node.args = [self._visited(each) for each in node.args]
        for keyword in node.keywords:
            keyword.value = self._visited(keyword.value)
        return node


def parts_of(expression: ast.expr) -> ast.expr:
    """Returns an expression of an object as one of its parts, where they need no object.

    Args:
        expression: What is lowered already.
    """
    if isinstance(expression, ast.Call):
        module, function = chain_of(expression.func)
        known = CONVERSIONS.get(function) if module == "conversions" else None
        if known is not None and known.outputs == (QUATERNION,) and QUATERNION not in known.inputs:
            return _call(f"rotations.{function}", *expression.args)
    return expression


def stamp_of_time(instant: ast.expr, names: Names) -> ast.expr:
    """Returns the expression of the bits of a TimeStamp of JAUS.

    Args:
        instant: The expression of the instant.
        names: The names that it may use.
    """
    root, path = chain_of(instant)
    if root in names.roots:
        return _call("stamps.bits_of", *names.roots[root].parts(path, ("sec", "nanosec")))
    found = lowered(instant, names)
    if chain_of(found)[0]:
        parts = (ast.Attribute(found, each, ast.Load()) for each in ("sec", "nanosec"))
        return _call("stamps.bits_of", *parts)
    return _call("stamps.bits_of", ast.Starred(found, ast.Load()))


def _inlined(function: str, node: ast.Call) -> ast.expr:
    """A conversion as the arithmetic that it consists of, or as it is."""
    known = CONVERSIONS.get(function)
    if known is None:
        return node
    match node.args:
        case [ast.Call(func=callee, args=parts)] if known.inputs == (QUATERNION,) and (
            chain_of(callee) == ("conversions", "Quaternion")
        ):
            return _call(f"rotations.{function}", *parts)
    formula = known.formula
    twice = any(formula.count(f"{{{index}}}") > 1 for index in range(len(node.args)))
    if not formula or (
        twice and not all(isinstance(each, (ast.Name, ast.Constant)) for each in node.args)
    ):
        return node
    names = [f"argument_{index}" for index in range(len(node.args))]
    expression = ast.parse(formula.format(*names), mode="eval").body
    found = _Arguments(dict(zip(names, node.args, strict=True))).visit(expression)
    return found if isinstance(found, ast.expr) else node


class _Arguments(ast.NodeTransformer):
    """Puts arguments in the place of names."""

    def __init__(self, arguments: Mapping[str, ast.expr]) -> None:
        self._arguments = arguments

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """The argument that a name stands for."""
        return self._arguments.get(node.id, node)


def _inlined_arithmetic(function: str, node: ast.Call) -> ast.expr:
    """A function of expressions as the arithmetic that it consists of, or as it is."""
    match function, node.args:
        case "divide", [dividend, ast.Constant(value=float() as divisor)] if divisor:
            return ast.BinOp(dividend, ast.Div(), ast.Constant(divisor))
        case "direction", [y, x]:
            return _call("math.atan2", y, x)
        case "length", [x, y]:
            return _call("math.hypot", x, y)
        case "magnitude", [value]:
            return _call("abs", value)
    return node
