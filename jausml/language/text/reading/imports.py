"""Targets of imports: files beside the text, or those of the shipped library."""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import quote

from jausml.language.model.notation import Fault, ImportedDocument
from jausml.language.model.uris import LIBRARY_URI, library_root
from jausml.language.model.values import show, suggest
from jausml.language.text.tree import Text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.text.tree import Import

_SUFFIXES = (".xmi", ".ros2jaus")


def resolve(item: Import) -> ImportedDocument | Fault:
    """Returns the document that an import names."""
    target = item.target
    line, column = target.span.line, target.span.column
    if isinstance(target, Text):
        if not target.text.strip():
            return Fault("JML704", "an import names a file", line=line, column=column)
        is_uri = target.text.startswith(LIBRARY_URI)
        uri = target.text if is_uri else quote(target.text, safe="/:")
        return ImportedDocument(uri, line, column)
    known = library_files()
    path = known.get(target.text)
    if path is not None:
        return ImportedDocument(f"{LIBRARY_URI}{path}", line, column)
    ends = [name for name in known if name.partition(".")[2] == target.text]
    hint = f"did you mean '{ends[0]}'?" if ends else suggest(target.text, known)
    hint = hint or 'a file of yours stands in quotation marks: import "robot.xmi"'
    message = f"the library has no {show(target.text)}"
    return Fault("JML704", message, hint, line, column)


def library_files() -> Mapping[str, str]:
    """Returns the files of the library (relative, forward slashes) by their names in imports."""
    root = library_root()
    paths = sorted(path.relative_to(root) for path in root.rglob("*") if path.suffix in _SUFFIXES)
    return {".".join(path.with_suffix("").parts): path.as_posix() for path in paths}
