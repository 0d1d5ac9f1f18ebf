"""Classes of users' files, and their methods against those that generated bases call."""

from __future__ import annotations

import ast
import difflib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generation.contract.finding import (
    Edit,
    File,
    Finding,
    FindingKind,
    attribute_edit,
    name_edit,
)
from jausml.generation.contract.syntax import flat, last_name

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Definition:
    """A name defined in the body of a class.

    Attributes:
        function: The function; None for an assignment (`on_x = helper`).
    """

    line: int
    function: Function | None


@dataclass(frozen=True)
class SourceClass:
    """A class of the file.

    Attributes:
        ancestors: Names of the base classes, as they were called where they were imported from;
            with those of base classes in the same file.
    """

    name: str
    line: int
    methods: dict[str, Definition]
    ancestors: frozenset[str]


def read_classes(tree: ast.Module) -> dict[str, SourceClass]:
    """Returns the top-level classes of a Python file by name."""
    statements = list(flat(tree.body))
    # Bases are known by the names that they have in the generated code.
    aliases = {
        alias.asname: alias.name
        for statement in statements
        if isinstance(statement, ast.ImportFrom)
        for alias in statement.names
        if alias.asname
    }
    classes: dict[str, SourceClass] = {}
    for statement in statements:
        if isinstance(statement, ast.ClassDef):
            classes[statement.name] = _read_class(statement, aliases, classes)
    return classes


def _read_class(
    node: ast.ClassDef, aliases: dict[str, str], earlier: dict[str, SourceClass]
) -> SourceClass:
    bases = [name for name in map(last_name, node.bases) if name]
    methods: dict[str, Definition] = {}
    ancestors = {aliases.get(name, name) for name in bases}
    # Of several bases, the first has the last word.
    for base in (earlier[name] for name in reversed(bases) if name in earlier):
        methods.update(base.methods)
        ancestors |= base.ancestors
    for statement in flat(node.body):
        methods.update(_definitions(statement))
    return SourceClass(node.name, node.lineno, methods, frozenset(ancestors))


def _definitions(statement: ast.stmt) -> Iterator[tuple[str, Definition]]:
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef)):
        yield statement.name, Definition(statement.lineno, statement)
    elif isinstance(statement, ast.Assign):
        for target in statement.targets:
            if isinstance(target, ast.Name):
                yield target.id, Definition(statement.lineno, None)
    elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
        yield statement.target.id, Definition(statement.lineno, None)


_SIMILAR = 0.6  # ratio of difflib above which two method names may be one renamed


@dataclass
class Comparison:
    """A user's class, compared with the methods that its base calls.

    Attributes:
        uncalled: Methods that the base calls no more.
        renamed: Those of them that it calls by another name, for certain.
    """

    findings: list[Finding] = field(default_factory=list)
    uncalled: set[str] = field(default_factory=set)
    renamed: dict[str, str] = field(default_factory=dict)


def compare_class(file: File, contract: SkeletonContract, known: Mapping[str, str]) -> Comparison:
    """Compares the class of a skeleton with the contract."""
    comparison = Comparison()
    classes = read_classes(file.tree)
    user = classes.get(contract.class_name)
    if user is None:
        comparison.findings.append(_no_class(file.path, contract, classes))
        return comparison
    comparison.findings += _compare_methods(file, contract, user, known, comparison)
    if contract.base_name not in user.ancestors:
        message = f"class {user.name} does not derive from {contract.base_name}"
        comparison.findings.append(Finding(FindingKind.NO_BASE, file.path, user.line, message))
    return comparison


def _no_class(path: str, contract: SkeletonContract, classes: Mapping[str, SourceClass]) -> Finding:
    heirs = [
        source_class
        for source_class in classes.values()
        if contract.base_name in source_class.ancestors
    ]
    message = f"there is no class {contract.class_name}({contract.base_name})"
    if heirs:
        message += f"; is it {heirs[0].name}, which derives from {contract.base_name}?"
    return Finding(
        FindingKind.NO_CLASS, path, heirs[0].line if heirs else 1, message, is_fatal=True
    )


def _compare_methods(
    file: File,
    contract: SkeletonContract,
    user: SourceClass,
    known: Mapping[str, str],
    comparison: Comparison,
) -> Iterator[Finding]:
    path, expected = file.path, {method.name: method for method in contract.methods}
    missing = {name: method for name, method in expected.items() if name not in user.methods}
    orphans = {
        name: definition
        for name, definition in user.methods.items()
        if name not in expected and (name.startswith(contract.prefixes) or name in known)
    }
    for name, definition in orphans.items():
        comparison.uncalled.add(name)
        successor = _successor(name, orphans, missing, known)
        if successor is None:
            message = f"{name}: the model has no such element any more, nothing calls it"
            yield Finding(FindingKind.ORPHAN, path, definition.line, message)
        else:
            # Each method is the successor of one orphan alone.
            del missing[successor.name]
            message = f"{name}: renamed to {successor.name}?"
            edits: tuple[Edit, ...] = ()
            if known.get(name):
                message = f"{name}: renamed to {successor.name}"
                comparison.renamed[name] = successor.name
                edits = _renaming(file, user, definition, name, successor)
            yield Finding(
                FindingKind.RENAMED, path, definition.line, message, successor.stub, edits=edits
            )
    for method in missing.values():
        if not method.optional:
            message = f"{user.name} does not define {_signature(method)}"
            yield Finding(FindingKind.MISSING, path, user.line, message, method.stub)
    yield from _misfits(path, user, expected)


def _misfits(
    path: str, user: SourceClass, expected: Mapping[str, MethodContract]
) -> Iterator[Finding]:
    for name, definition in user.methods.items():
        if name in expected and definition.function is not None:
            problem = _signature_problem(definition.function, expected[name])
            if problem:
                message = f"{name}: {problem}, expected {_signature(expected[name])}"
                is_fatal = problem.startswith(("takes (", "requires"))
                yield Finding(
                    FindingKind.SIGNATURE, path, definition.line, message, is_fatal=is_fatal
                )


def _successor(
    name: str,
    orphans: Mapping[str, Definition],
    missing: Mapping[str, MethodContract],
    known: Mapping[str, str],
) -> MethodContract | None:
    """Returns the method that an orphan probably is now.

    The identity in the manifest decides; without one, names that resemble each other and nothing
    else do.
    """
    if known.get(name):
        same = [method for method in missing.values() if method.identity == known[name]]
        return same[0] if len(same) == 1 else None
    candidates = [candidate for candidate in missing if _resemble(name, candidate)]
    if len(candidates) != 1:
        return None
    rivals = [rival for rival in orphans if _resemble(rival, candidates[0])]
    return missing[candidates[0]] if len(rivals) == 1 else None


def _renaming(
    file: File, user: SourceClass, definition: Definition, name: str, successor: MethodContract
) -> tuple[Edit, ...]:
    """Returns the edits that rename a method, where no other name in the file is the same."""
    function = definition.function
    used = [node for node in file.nodes if isinstance(node, ast.Attribute) and node.attr == name]
    defined = [node for node in file.nodes if isinstance(node, Function) and node.name == name]
    is_certain = (
        function is not None
        and defined == [function]
        and successor.name not in user.methods
        and not _signature_problem(function, successor)
        and all(last_name(attribute.value) in ("self", "super") for attribute in used)
        # A text may name the method, as for getattr, and no edit would follow it.
        and name not in file.words
    )
    if function is None or not is_certain:
        return ()
    head = "async def " if isinstance(function, ast.AsyncFunctionDef) else "def "
    edits = [name_edit(function.lineno, function.col_offset + len(head), name, successor.name)]
    edits += [attribute_edit(attribute, successor.name) for attribute in used]
    return tuple(edits)


def _resemble(first: str, second: str) -> bool:
    # Without the prefix as well: `on_` alone makes names alike.
    pairs = [(first.partition("_")[2], second.partition("_")[2]), (first, second)]
    return all(difflib.SequenceMatcher(None, a, b).ratio() >= _SIMILAR for a, b in pairs)


def _signature(method: MethodContract) -> str:
    return f"{method.name}({', '.join(('self', *method.parameters))})"


def _signature_problem(function: Function, method: MethodContract) -> str:
    """Says why the base's call, by position, does not fit; other parameter names do no harm."""
    if isinstance(function, ast.AsyncFunctionDef):
        return "is async, but the base does not await it"
    if any(
        isinstance(decorator, ast.Name) and decorator.id == "staticmethod"
        for decorator in function.decorator_list
    ):
        return "is a static method"
    arguments = function.args
    # A leading underscore says only that a parameter is not used.
    names = [argument.arg.lstrip("_") for argument in (*arguments.posonlyargs, *arguments.args)][1:]
    wanted = [name.lstrip("_") for name in method.parameters]
    required = len(names) - len(arguments.defaults)
    if len(wanted) < required or (len(wanted) > len(names) and arguments.vararg is None):
        return f"takes ({', '.join(names)})"
    if None in arguments.kw_defaults:
        return "requires keyword arguments"
    swapped = any(
        name != wanted_name and wanted_name in names
        for name, wanted_name in zip(names, wanted, strict=False)
    )
    return f"takes its parameters in another order ({', '.join(names)})" if swapped else ""
