"""Texts: written, read, and compared with markers that stand at the findings."""

from pathlib import Path

from reader_support import strip

from jausml.language.model import read_models
from jausml.language.model.comparison import compare
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check


class Texts:
    """A folder of documents that can be read."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, name: str, text: str | bytes) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    def read(self, *names: str):
        paths = [self.folder / name for name in names]
        return read_models(paths, project_root=self.folder, notations=NOTATIONS)

    def one(self, text: str | bytes, name: str = "demo.ros2jaus"):
        """Reads one document."""
        self.write(name, text)
        return self.read(name)

    def good(self, text: str, name: str = "demo.ros2jaus"):
        """Reads one document that the reader has nothing to complain of; returns its model."""
        result = self.one(text, name)
        assert result.diagnostics == []
        return result.model

    def check(self, text: str):
        """Reads a document with markers: they stand exactly where the reader's findings are."""
        plain, expected = strip(text)
        result = self.one(plain)
        found = [(d.location.line, d.location.column, d.rule) for d in result.diagnostics]
        assert sorted(found) == expected, "\n".join(map(str, result.diagnostics))
        return result.diagnostics

    def rules(self, text: str) -> list[str]:
        """Returns the rules of all findings about a document, those of the engine included."""
        return [diagnostic.rule for diagnostic in check(self.one(text)).diagnostics]


def same(model, ours, theirs) -> bool:
    """Tells whether two elements of a model hold the same."""
    return compare(ours, theirs, model.metamodels) == []
