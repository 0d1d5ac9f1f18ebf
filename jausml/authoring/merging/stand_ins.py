"""Stand-ins for elements of other files which are not there yet, so that references keep them.

git merges one file at a time. What theirs refers to may stand in a file that it has not merged
yet, and a model that was moved to another folder refers from its former one to nothing. For a merge
it is enough to know which element is meant: a file with an empty element of that id takes its
place.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.authoring.editing.reading import XMI_SUFFIX
from jausml.language.model.inputs import read_input
from jausml.language.model.xmi.writer import attribute_text

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from jausml.language.metamodel import ClassTable, Metamodels
    from jausml.language.model.reading.reader import LostReference

_ID = re.compile(r"[^\s/#:?%][^\s#:?%]*")
_XMI = b'<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI">'
_DECLARATION = re.compile(rb"\s*<\?xml[^>]*\?>")


def stand_ins(lost: Iterable[LostReference], metamodels: Metamodels) -> dict[Path, bytes]:
    """Returns files that have what references miss, behind what the files have already.

    Args:
        lost: References that lead to no element. Those by position or by name have no stand-in,
            nor have those to what is no XMI in UTF-8.
    """
    elements: dict[Path, dict[str, ClassTable]] = {}
    for each in lost:
        table = _concrete(each.feature.target)
        path = each.path
        if path is None or table is None or not _ID.fullmatch(each.fragment):
            continue
        if path.name.endswith(XMI_SUFFIX):
            elements.setdefault(path, {}).setdefault(each.fragment, table)
    uris = {each.name: each.ns_uri for each in metamodels.packages.values()}
    return {
        path: b"\n".join([_XMI, _present(path), *(_line(*e, uris) for e in found.items())])
        + b"\n</xmi:XMI>\n"
        for path, found in elements.items()
    }


def _concrete(table: ClassTable | None) -> ClassTable | None:
    """Returns a class that elements can have, of those that fit a reference."""
    if table is None or not table.abstract:
        return table
    fitting = (each for each in table.subtypes if not each.abstract)
    return min(fitting, key=lambda each: each.qualified_name, default=None)


def _line(identifier: str, table: ClassTable, uris: dict[str, str]) -> bytes:
    package = table.package.name
    declared = f'xmlns:{package}="{uris[package]}"'
    tag = f"{package}:{table.name}"
    return f'<{tag} {declared} xmi:id="{attribute_text(identifier)}"/>'.encode()


def _present(path: Path) -> bytes:
    """Returns what a file has already, to stand in another document."""
    try:
        data = read_input(path)
    except OSError:
        return b""
    return _DECLARATION.sub(b"", data.removeprefix(b"\xef\xbb\xbf"), count=1)
