"""Drift of users' files from the model, told from their syntax trees alone.

The files are parsed, never imported. They are compared with the interface that the files of this
run are, and those that stay on the disk beside them.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from jausml.generation.artifact import Artifact, Kind, path_problem
from jausml.generation.contract.finding import File, Finding, FindingKind
from jausml.generation.contract.imports import Surroundings
from jausml.generation.contract.interface import Interface
from jausml.generation.contract.overrides import compare_class
from jausml.generation.contract.symbols import Class, Module
from jausml.generation.contract.syntax import SourceProblem, absolute, tree_of
from jausml.generation.contract.types import Types
from jausml.generation.contract.uses import misfits
from jausml.generation.manifest import Manifest, find_python, inspect
from jausml.language.model.files import read_input


def drift(
    artifacts: Sequence[Artifact],
    out: Path,
    manifest: Manifest,
    *,
    deleted: frozenset[str] = frozenset(),
    former: Mapping[str, str] | None = None,
) -> list[Finding]:
    """Compares the user's files in a workspace with the generated interface.

    Args:
        former: Names that the interface had, with those that they have now.
    """
    interface = Interface(artifacts, out, manifest, deleted)
    skeletons = {
        artifact.path: artifact for artifact in artifacts if artifact.kind is Kind.SKELETON
    }
    findings: list[Finding] = []
    files: list[File] = []
    for path in _paths(out, interface, skeletons):
        try:
            data = read_input(out / path)
            if path in skeletons or interface.may_import(path, data):
                files.append(File(path, data, tree_of(data)))
        except SourceProblem as problem:
            if path in skeletons or interface.is_inside(path):
                findings.append(_unreadable(path, problem.line, str(problem)))
        except OSError as error:
            if path in skeletons:
                findings.append(_unreadable(path, 1, f"cannot be read: {error.strerror}"))
    findings += _compared(files, interface, skeletons, manifest, former or {})
    return sorted(
        findings,
        key=lambda finding: (
            finding.path,
            finding.line,
            finding.column,
            finding.kind.value,
            finding.message,
        ),
    )


def _unreadable(path: str, line: int, message: str) -> Finding:
    return Finding(FindingKind.SYNTAX, path, line, message, is_fatal=True)


def _paths(out: Path, interface: Interface, skeletons: Mapping[str, Artifact]) -> Iterator[str]:
    """Yields the paths of the user's files: skeletons, and files beside them."""
    for path, artifact in skeletons.items():
        state = inspect(out, path) if path_problem(path) is None else None
        if artifact.contract is not None and state is not None and state.exists:
            yield path
    for path in find_python(out):
        if path not in skeletons and not interface.is_generated(path):
            yield path


def _compared(
    files: Sequence[File],
    interface: Interface,
    skeletons: Mapping[str, Artifact],
    manifest: Manifest,
    former: Mapping[str, str],
) -> Iterator[Finding]:
    imported = frozenset(pair for file in files for pair in _imported(file))
    derived = frozenset(name for file in files for name in file.derived)
    types = Types(interface.modules)
    for file in files:
        contract = skeletons[file.path].contract if file.path in skeletons else None
        known: dict[str, str] = dict(former)
        uncalled: frozenset[str] = frozenset()
        if contract is not None:
            entry = manifest.files.get(file.path)
            methods = entry.methods if entry else {}
            comparison = compare_class(file, contract, methods)
            yield from comparison.findings
            uncalled = frozenset(comparison.uncalled)
            base = _base(interface, file, contract.class_name, contract.base_name)
            known |= {f"{base}.{old}": new for old, new in comparison.renamed.items()}
        around = Surroundings(types, known, derived, imported, uncalled)
        yield from misfits(file, around)


def _imported(file: File) -> Iterator[tuple[str, str]]:
    """Yields the imports of a file from other modules, by module and name."""
    module = file.module
    for node in ast.walk(file.tree):
        if isinstance(node, ast.ImportFrom):
            source = absolute(node, module.name, is_package=module.is_package)
            yield from ((source, alias.name) for alias in node.names)


def _base(interface: Interface, file: File, class_name: str, base_name: str) -> str:
    """Returns the dotted name of the generated base of a class."""
    name = file.module.name
    module = interface.modules.find(name) if name else None
    user = interface.modules.member(module, class_name) if isinstance(module, Module) else None
    if isinstance(user, Class):
        for ancestor in interface.modules.ancestors(user):
            if isinstance(ancestor, Class) and ancestor.name == base_name:
                return f"{ancestor.module.name}.{ancestor.name}"
    return ""
