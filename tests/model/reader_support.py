"""Documents in texts: written, read, and compared with markers that stand at the findings."""

import re
from pathlib import Path
from typing import Any, ClassVar

from jausml.language.metamodel import read_metamodels
from jausml.language.model import read_models

EMF = Path(__file__).parent / "emf"
ZOO_METAMODELS = read_metamodels([EMF / "zoo.ecore"])

XMLNS = (
    'xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    ' xmlns:zoo="http://www.example.org/zoo/1.0"'
    ' xmlns:birds="http://www.example.org/zoo/birds/1.0"'
)
MARKER = re.compile(r"⟦(JML\d\d\d)⟧")


def zoo(body: str = "", attributes: str = 'name="Z"') -> str:
    """Returns a document with a Zoo."""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<zoo:Zoo {XMLNS}\n    {attributes}>\n{body}\n'
        "</zoo:Zoo>\n"
    )


def strip(text: str) -> tuple[str, list[tuple[int, int, str]]]:
    """Removes markers and returns where they stood: line, column, rule."""
    expected = []
    while match := MARKER.search(text):
        before = text[: match.start()]
        line = before.count("\n") + 1
        column = len(before) - (before.rfind("\n") + 1) + 1
        expected.append((line, column, match.group(1)))
        text = before + text[match.end() :]
    return text, sorted(expected)


class Files:
    """A folder of documents that can be read."""

    name = "model.xmi"
    options: ClassVar[dict[str, Any]] = {"metamodels": ZOO_METAMODELS}

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, name: str, text: str | bytes) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    def read(self, *names: str, **options):
        options = {"project_root": self.folder, **self.options, **options}
        return read_models([self.folder / name for name in names], **options)

    def one(self, text: str | bytes, name: str = "", **options):
        """Reads one document."""
        self.write(name or self.name, text)
        return self.read(name or self.name, **options)

    def good(self, text: str | bytes, name: str = "", **options):
        """Reads one document that has nothing to complain of, and returns its model."""
        result = self.one(text, name, **options)
        assert result.diagnostics == []
        return result.model

    def check(self, text: str, **options):
        """Reads a document with markers: they stand exactly where the findings are."""
        plain, expected = strip(text)
        result = self.one(plain, **options)
        found = [(d.location.line, d.location.column, d.rule) for d in result.diagnostics]
        assert sorted(found) == expected, "\n".join(map(str, result.diagnostics))
        return result
