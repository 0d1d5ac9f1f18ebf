"""Drift of a user's skeleton from the model, told from its syntax tree alone.

The user's file is parsed, never imported and never edited.
"""

from __future__ import annotations

import ast
import difflib
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from jausml.generation.artifact import Artifact, Kind, MethodContract, SkeletonContract
from jausml.generation.checks import path_problem
from jausml.generation.folder import inspect
from jausml.generation.source import (
    Definition,
    Function,
    GeneratedNames,
    SourceClass,
    SourceProblem,
    read_classes,
    read_imports,
)
from jausml.language.model.inputs import read_input

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from jausml.generation.manifest import Manifest

_SIMILAR = 0.6  # ratio of difflib above which two method names may be one renamed


class FindingKind(Enum):
    """What is wrong with a user's file."""

    MISSING = "missing-method"
    ORPHAN = "orphan-method"
    SIGNATURE = "signature-differs"
    RENAMED = "renamed-method"
    NO_CLASS = "missing-class"
    NO_BASE = "missing-base"
    IMPORT = "lost-import"
    SYNTAX = "syntax-error"


_SEVERITIES = {FindingKind.MISSING: "info", FindingKind.SYNTAX: "error"}


@dataclass(frozen=True)
class Finding:
    """One difference between a user's file and the model.

    Attributes:
        path: The file, relative to the output folder.
        line: Line in the file, from 1.
        stub: Ready text of the method that the model expects, or empty.
    """

    kind: FindingKind
    path: str
    line: int
    message: str
    stub: str = ""

    @property
    def severity(self) -> str:
        """`error`, `warning` or `info`."""
        return _SEVERITIES.get(self.kind, "warning")


def drift(artifacts: Sequence[Artifact], out: Path, manifest: Manifest) -> list[Finding]:
    """Compares the user's existing skeleton files with the model.

    Args:
        artifacts: The files of this run; skeletons with a contract are looked at.

    Returns:
        The findings by path and line.
    """
    findings: list[Finding] = []
    generated = GeneratedNames(artifacts)
    for artifact in artifacts:
        if artifact.kind is not Kind.SKELETON or path_problem(artifact.path) is not None:
            continue
        if artifact.contract is not None and inspect(out, artifact.path).exists:
            entry = manifest.files.get(artifact.path)
            known = entry.methods if entry else {}
            findings += _compare_file(out, artifact.path, artifact.contract, known)
            findings += _lost_imports(out, artifact.path, generated, manifest)
    return sorted(findings, key=lambda f: (f.path, f.line, f.kind.value, f.message))


def _compare_file(
    out: Path, path: str, contract: SkeletonContract, known: Mapping[str, str]
) -> list[Finding]:
    try:
        classes = read_classes(read_input(out / path))
    except SourceProblem as problem:
        return [Finding(FindingKind.SYNTAX, path, problem.line, str(problem))]
    except OSError as error:
        return [Finding(FindingKind.SYNTAX, path, 1, f"cannot be read: {error.strerror}")]
    user = classes.get(contract.class_name)
    if user is None:
        return [_no_class(path, contract, classes)]
    findings = list(_compare_methods(path, contract, user, known))
    if contract.base_name not in user.ancestors:
        message = f"class {user.name} does not derive from {contract.base_name}"
        findings.append(Finding(FindingKind.NO_BASE, path, user.line, message))
    return findings


def _lost_imports(
    out: Path, path: str, generated: GeneratedNames, manifest: Manifest
) -> Iterator[Finding]:
    """Yields imports from generated modules that this run no longer writes."""
    try:
        imports = read_imports(read_input(out / path))
    except (SourceProblem, OSError):
        return  # told by the comparison of classes
    for each in imports:
        message = generated.missing(each)
        if message and not _is_users(each.module, out, manifest):
            yield Finding(FindingKind.IMPORT, path, each.line, message)


def _is_users(module: str, out: Path, manifest: Manifest) -> bool:
    """Tells whether a module of a generated package is a file that the user put there."""
    place = "/".join((module.partition(".")[0], *module.split(".")))
    found = [each for each in (f"{place}.py", f"{place}/__init__.py") if (out / each).is_file()]
    return any(each not in manifest.files for each in found)


def _no_class(path: str, contract: SkeletonContract, classes: Mapping[str, SourceClass]) -> Finding:
    heirs = [c for c in classes.values() if contract.base_name in c.ancestors]
    message = f"there is no class {contract.class_name}({contract.base_name})"
    if heirs:
        message += f"; is it {heirs[0].name}, which derives from {contract.base_name}?"
    return Finding(FindingKind.NO_CLASS, path, heirs[0].line if heirs else 1, message)


def _compare_methods(
    path: str, contract: SkeletonContract, user: SourceClass, known: Mapping[str, str]
) -> Iterator[Finding]:
    expected = {method.name: method for method in contract.methods}
    missing = {n: m for n, m in expected.items() if n not in user.methods}
    orphans = {
        name: definition
        for name, definition in user.methods.items()
        if name not in expected and (name.startswith(contract.prefixes) or name in known)
    }
    for name, definition in orphans.items():
        successor = _successor(name, orphans, missing, known)
        if successor is None:
            message = f"{name}: the model has no such element any more, nothing calls it"
            yield Finding(FindingKind.ORPHAN, path, definition.line, message)
        else:
            del missing[successor.name]
            message = f"{name}: renamed to {successor.name}?"
            yield Finding(FindingKind.RENAMED, path, definition.line, message, successor.stub)
    for method in missing.values():
        if not method.optional:
            message = f"{user.name} does not define {_signature(method)}"
            yield Finding(FindingKind.MISSING, path, user.line, message, method.stub)
    for name, definition in user.methods.items():
        if name in expected and definition.function is not None:
            problem = _signature_problem(definition.function, expected[name])
            if problem:
                message = f"{name}: {problem}, expected {_signature(expected[name])}"
                yield Finding(FindingKind.SIGNATURE, path, definition.line, message)


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
    candidates = [n for n in missing if _resemble(name, n)]
    if len(candidates) != 1:
        return None
    rivals = [n for n in orphans if _resemble(n, candidates[0])]
    return missing[candidates[0]] if len(rivals) == 1 else None


def _resemble(first: str, second: str) -> bool:
    pairs = [(first.partition("_")[2], second.partition("_")[2]), (first, second)]
    return all(difflib.SequenceMatcher(None, a, b).ratio() >= _SIMILAR for a, b in pairs)


def _signature(method: MethodContract) -> str:
    return f"{method.name}({', '.join(('self', *method.parameters))})"


def _signature_problem(function: Function, method: MethodContract) -> str:
    """Says why the base's call, by position, does not fit; other parameter names do no harm."""
    if isinstance(function, ast.AsyncFunctionDef):
        return "is async, but the base does not await it"
    if any(isinstance(d, ast.Name) and d.id == "staticmethod" for d in function.decorator_list):
        return "is a static method"
    arguments = function.args
    names = [a.arg.lstrip("_") for a in (*arguments.posonlyargs, *arguments.args)][1:]
    wanted = [name.lstrip("_") for name in method.parameters]
    required = len(names) - len(arguments.defaults)
    if len(wanted) < required or (len(wanted) > len(names) and arguments.vararg is None):
        return f"takes ({', '.join(names)})"
    if None in arguments.kw_defaults:
        return "requires keyword arguments"
    swapped = any(n != w and w in names for n, w in zip(names, wanted, strict=False))
    return f"takes its parameters in another order ({', '.join(names)})" if swapped else ""
