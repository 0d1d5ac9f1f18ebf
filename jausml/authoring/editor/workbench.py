"""Workbench of the editor: the texts that are open, the files beside them, and the library."""

from __future__ import annotations

import os
import re
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from jausml.authoring.editor.names import Names, names_of
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.model.files import read_input
from jausml.language.model.library import LIBRARY_URI, library_root, module_of
from jausml.language.model.model import Model
from jausml.language.model.names import qualified_name
from jausml.language.model.project import made_project, model_files
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.project import Index, Models, library, own_instances, stored_files
from jausml.language.text.notation import NOTATIONS, SUFFIX, decode
from jausml.language.text.reading.imports import resolve
from jausml.language.text.reading.parsing import parsed_text
from jausml.language.text.tree import Import, Span, SyntaxTree, Text
from jausml.language.text.writing.spelling import quoted
from jausml.language.validation.engine import RuleError, check

ElementT = TypeVar("ElementT", bound="EObject")

_WORD = re.compile(r"[^\s,(){}\[\]]+|.")


def names_in(text: str) -> Names:
    """Returns the names in a text."""
    return names_of(parsed_text(text).document)


@dataclass
class Workbench:
    """The open texts, and the models that were read of them.

    `root`: the folder outside of which nothing but the library is read, symbolic links followed;
    None for no limit.
    """

    texts: dict[Path, str] = field(default_factory=dict)
    root: Path | None = None
    _models: dict[Path, Model] = field(default_factory=dict)
    _beside: dict[Path, Model] = field(default_factory=dict)
    _read: dict[Path, Models] = field(default_factory=dict)
    _library: LibraryCache = field(default_factory=LibraryCache)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def text(self, path: Path) -> str:
        """Returns the text of a file, as the editor has it or as it is stored; empty if neither."""
        held = self.texts.get(path)
        if held is not None:
            return held
        if not self._may_read(path):
            return ""
        try:
            return decode(read_input(path))[0]
        except OSError:
            return ""

    def _may_read(self, path: Path) -> bool:
        if self.root is None:
            return True
        real = path.resolve()
        return any(real.is_relative_to(folder) for folder in (self.root, library_root().resolve()))

    def findings(
        self, path: Path, is_wanted: Callable[[], bool] = lambda: True
    ) -> list[Diagnostic]:
        """Reads an open text with all files that it refers to, and checks it.

        May run beside everything else. What was read answers later questions. Returns what was
        found in this text. `SupersededError`: `is_wanted` says meanwhile that nobody asks any more.
        """
        # A copy: the editor may open and close texts meanwhile.
        held = dict(self.texts)
        contents = {file: text.encode("utf-8", "replace") for file, text in held.items()}
        with self._lock:
            result = read_models(
                [path],
                project_root=self.root,
                notations=NOTATIONS,
                contents=contents,
                cache=self._library,
            )
            self._models[path] = result.model
            self._read_beside(path, contents)
        shown = result.model.documents[0].display
        diagnostics = checked(result, is_wanted)
        return [diagnostic for diagnostic in diagnostics if diagnostic.location.path == shown]

    def _read_beside(self, path: Path, held: Mapping[Path, bytes]) -> None:
        """Reads the other files of the project of a text, which a text can name by an import."""
        root = made_project(path.parent)
        if root is None or not self._may_read(root):
            return
        inside = {
            held_path: data for held_path, data in held.items() if held_path.is_relative_to(root)
        }
        texts = {held_path.relative_to(root).as_posix(): data for held_path, data in inside.items()}
        models = self._read.setdefault(root, Models(root, NOTATIONS, self._library))
        index = Index(root, {**stored_files(root), **texts}, models)
        file = path.resolve().relative_to(root).as_posix()
        self._beside[path] = index.beside(file, self._models[path])

    def forget(self, path: Path) -> None:
        """Forgets a text that is no longer open."""
        self.texts.pop(path, None)
        self._models.pop(path, None)
        self._beside.pop(path, None)

    def elements(self, path: Path, kind: type[ElementT]) -> list[ElementT]:
        """Returns the elements of a class that a text can name: its own, then the library's.

        Between them stand those of the project's other files, which a text has to import.
        """
        known = (self._models.get(path), self._beside.get(path))
        own = own_instances([model for model in known if model is not None], kind)
        return [*own, *library().instances(kind)]

    def find(self, path: Path, kind: type[ElementT], name: str) -> ElementT | None:
        """Returns the first element of a class that a name means in a text, None without one."""
        wanted = f".{name.replace('/msg/', '/').replace('/', '.')}"
        for element in self.elements(path, kind):
            if f".{qualified_name(element)}".endswith(wanted):
                return element
        return None

    def tree(self, path: Path) -> SyntaxTree:
        """Returns the syntax tree of a text."""
        return parsed_text(self.text(path)).document

    def module_of(self, path: Path, element: EObject) -> str:
        """Returns the module that a text imports for an element; empty for one that it knows."""
        document = library().document_of(element)
        return module_of(document.path) if document is not None else self.file_of(path, element)

    def file_of(self, path: Path, element: EObject) -> str:
        """Returns the file that a text imports for an element, quoted; empty if it needs none."""
        beside = self._beside.get(path)
        document = beside.document_of(element) if beside is not None else None
        if document is None or document.is_library:
            return ""
        return quoted(Path(os.path.relpath(document.path, path.parent)).as_posix())

    def place_of(self, path: Path, element: EObject) -> tuple[Path, int, int] | None:
        """Returns file, line and column of an element that `elements` gave."""
        for model in (self._models.get(path), self._beside.get(path), library()):
            document = model.document_of(element) if model is not None else None
            if model is not None and document is not None:
                location = model.location(element)
                return document.path, location.line, location.column
        return None

    def imports(self, path: Path) -> list[Path]:
        """Returns the files that a text imports, whether they are there or not."""
        files = (imported_file(statement, path) for statement in imports_of(self.tree(path)))
        return [file for file in files if file is not None]

    def related(self, path: Path) -> list[Path]:
        """Returns a text, those of its project, the open ones, and all texts that these import."""
        paths: dict[Path, None] = {}
        pending = [*self.texts, path]
        if root := self.root or made_project(path.parent):
            pending += [root / file for file in model_files(root, (SUFFIX,))]
        while pending:
            text_path = pending.pop()
            if text_path.suffix == SUFFIX and text_path not in paths:
                paths[text_path] = None
                pending += self.imports(text_path)
        return list(paths)


def imports_of(tree: SyntaxTree) -> list[Import]:
    """Returns the imports of a text."""
    return [item for item in tree.items if isinstance(item, Import)]


def imported_file(item: Import, path: Path) -> Path | None:
    """Returns the file that an import of a text names."""
    if isinstance(item.target, Text) and not item.target.text.startswith(LIBRARY_URI):
        return (path.parent / item.target.text).resolve() if item.target.text.strip() else None
    uri = getattr(resolve(item), "uri", None)
    if not isinstance(uri, str):
        return None
    return (library_root() / uri.removeprefix(LIBRARY_URI)).resolve()


def checked(
    result: ReadResult, is_wanted: Callable[[], bool] = lambda: True
) -> Sequence[Diagnostic]:
    """Returns the findings of a model that was read of texts."""
    try:
        return check(result, is_wanted=is_wanted).diagnostics
    except RuleError:
        # A rule that fails on a text half written says nothing about it.
        return result.diagnostics


@dataclass(frozen=True, slots=True)
class Problem:
    """A fault in a text."""

    span: Span
    severity: Severity
    rule: str
    message: str


def syntax_problems(text: str) -> list[Problem]:
    """Returns the syntax errors of a text."""
    return [
        Problem(fault.span, Severity.ERROR, "JML701", _with_hint(fault.message, fault.hint))
        for fault in parsed_text(text).faults
    ]


def all_problems(
    bench: Workbench, path: Path, is_wanted: Callable[[], bool] = lambda: True
) -> list[Problem]:
    """Reads an open text as a model and returns all that is wrong with it.

    `SupersededError`: `is_wanted` says meanwhile that nobody asks any more.
    """
    lines = bench.text(path).split("\n")
    return [
        Problem(
            _span(lines, finding.location.line, finding.location.column),
            finding.severity,
            finding.rule,
            _with_hint(finding.message, finding.hint),
        )
        for finding in bench.findings(path, is_wanted)
    ]


def _with_hint(message: str, hint: str) -> str:
    return f"{message} ({hint})" if hint else message


def _span(lines: list[str], line: int, column: int) -> Span:
    """Returns the word at a place, for a finding tells only where it begins."""
    text = lines[line - 1] if line <= len(lines) else ""
    word = _WORD.match(text, column - 1)
    return Span(line, column, line, word.end() + 1 if word is not None else column)
