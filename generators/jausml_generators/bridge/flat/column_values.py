"""Expressions on columns, arrays of numpy with one number for each element of a list."""

from __future__ import annotations

import ast

from jausml_generators.bridge.flat.errors import NotFlatError

_FUNCTIONS = {
    "conversions.wrap_angle": "columns.wrap_angle",
    "rotations.enu_quaternion_to_ned_angles": "columns.enu_quaternion_to_ned_angles",
    "rotations.flu_quaternion_to_frd_angles": "columns.flu_quaternion_to_frd_angles",
    "rotations.frd_angles_to_flu_quaternion": "columns.frd_angles_to_flu_quaternion",
    "rotations.ned_angles_to_enu_quaternion": "columns.ned_angles_to_enu_quaternion",
    "stamps.bits_of": "columns.bits_of",
    "stamps.time_of": "columns.time_of",
}


def columnwise(expression: ast.expr, arrays: set[str]) -> ast.expr:
    """Returns an expression on numbers as one on columns.

    Args:
        expression: What is lowered; it is changed.
        arrays: Local variables that are columns.

    Raises:
        NotFlatError: numpy would make something else of it.
    """
    found = _Columnwise(arrays).visit(expression)
    if not isinstance(found, ast.expr):
        raise NotFlatError("an expression has no value")
    return found


def is_true(test: ast.expr, arrays: set[str]) -> bool:
    """Tells whether a condition holds, which is known: no value of a column is None.

    Args:
        test: What is lowered.
        arrays: Local variables that are columns.

    Raises:
        NotFlatError: It depends on values.
    """
    match test:
        case ast.BoolOp(op=ast.And()):
            return all(is_true(each, arrays) for each in test.values)
        case ast.BoolOp():
            return any(is_true(each, arrays) for each in test.values)
        case ast.UnaryOp(op=ast.Not()):
            return not is_true(test.operand, arrays)
        case ast.Compare(left=ast.Name(id=name), ops=[ast.Is() | ast.IsNot() as sign]) if (
            name in arrays and _is_none(test.comparators[0])
        ):
            return isinstance(sign, ast.IsNot)
    raise NotFlatError(f"{ast.unparse(test)} differs from element to element")


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _numpy(function: str, *arguments: ast.expr) -> ast.expr:
    return ast.Call(ast.parse(f"numpy.{function}", mode="eval").body, list(arguments), [])


class _Columnwise(ast.NodeTransformer):
    """Puts arithmetic of numpy in the place of what differs from that of Python."""

    def __init__(self, arrays: set[str]) -> None:
        self._arrays = arrays

    def visit(self, node: ast.AST) -> ast.AST:
        """Leaves alone what is the same for all elements."""
        if isinstance(node, ast.expr) and not self._has_columns(node):
            return node
        handler = getattr(self, f"visit_{type(node).__name__}", None)
        if handler is None:
            raise NotFlatError(f"{ast.unparse(node)} has no columns")
        found: ast.AST = handler(node)
        return found

    def _has_columns(self, node: ast.AST) -> bool:
        return any(isinstance(n, ast.Name) and n.id in self._arrays for n in ast.walk(node))

    def _of(self, node: ast.expr) -> ast.expr:
        found = self.visit(node)
        if not isinstance(found, ast.expr):
            raise NotFlatError("an expression has no value")
        return found

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """A column."""
        return node

    def visit_Tuple(self, node: ast.Tuple) -> ast.AST:
        """Several of them."""
        return ast.Tuple([self._of(each) for each in node.elts], node.ctx)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        """The opposite sign."""
        if not isinstance(node.op, ast.USub):
            raise NotFlatError(f"{ast.unparse(node)} has no columns")
        return ast.UnaryOp(node.op, self._of(node.operand))

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """Arithmetic that fails for no numbers."""
        if isinstance(node.op, ast.Div) and not _is_number(node.right):
            raise NotFlatError(f"{ast.unparse(node)} may divide by zero")
        if not isinstance(node.op, ast.Add | ast.Sub | ast.Mult | ast.Div):
            raise NotFlatError(f"{ast.unparse(node)} has no columns")
        return ast.BinOp(self._of(node.left), node.op, self._of(node.right))

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        """Comparisons, each by itself."""
        if any(_is_none(each) for each in node.comparators):
            return ast.Constant(is_true(node, self._arrays))
        sides = [self._of(each) for each in (node.left, *node.comparators)]
        pairs = zip(sides, node.ops, sides[1:], strict=False)
        first, *others = (ast.Compare(left, [sign], [right]) for left, sign, right in pairs)
        return _joined(ast.BitAnd(), [first, *others])

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        """Conditions, of which numpy asks all."""
        if not all(isinstance(each, ast.Compare | ast.BoolOp) for each in node.values):
            raise NotFlatError(f"{ast.unparse(node)} is no condition")
        sign = ast.BitAnd() if isinstance(node.op, ast.And) else ast.BitOr()
        return _joined(sign, [self._of(each) for each in node.values])

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        """A choice for each element, or for all."""
        try:
            return self.visit(node.body if is_true(node.test, self._arrays) else node.orelse)
        except NotFlatError:
            parts = (self._of(each) for each in (node.test, node.body, node.orelse))
            return _numpy("where", *parts)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Functions that are there for columns."""
        function = ast.unparse(node.func)
        arguments = [self._of(each) for each in node.args]
        if function == "float" and isinstance(node.args[0], ast.Compare | ast.BoolOp):
            return ast.Call(ast.Attribute(arguments[0], "astype"), [ast.Constant("<f8")], [])
        if function == "float":
            return arguments[0]
        if function not in _FUNCTIONS or node.keywords:
            raise NotFlatError(f"{function} has no columns")
        return ast.Call(ast.parse(_FUNCTIONS[function], mode="eval").body, arguments, [])


def _joined(sign: ast.operator, conditions: list[ast.expr]) -> ast.expr:
    found, *others = conditions
    for each in others:
        found = ast.BinOp(found, sign, each)
    return found


def _is_number(node: ast.expr) -> bool:
    """Whether an expression is arithmetic of numbers other than zero."""
    if isinstance(node, ast.BinOp):
        return _is_number(node.left) and _is_number(node.right) and isinstance(node.op, ast.Div)
    return isinstance(node, ast.Constant) and type(node.value) in {int, float} and node.value != 0
