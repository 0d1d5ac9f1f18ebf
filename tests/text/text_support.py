"""Texts: written, read, and compared with markers that stand at the findings."""

from typing import ClassVar

from reader_support import Files

from jausml.language.model.comparison import compare
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check


class Texts(Files):
    """A folder of documents that can be read."""

    name = "demo.ros2jaus"
    options: ClassVar = {"notations": NOTATIONS}

    def rules(self, text: str) -> list[str]:
        """Returns the rules of all findings about a document, those of the engine included."""
        return [diagnostic.rule for diagnostic in check(self.one(text)).diagnostics]


def same(model, ours, theirs) -> bool:
    """Tells whether two elements of a model hold the same."""
    return compare(ours, theirs, model.metamodels) == []
