"""Commands on texts as an editor holds them: what they would change, without writing it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.drafts import Draft
from jausml.authoring.editing.executing import execute
from jausml.authoring.editing.reading import Reader, can_be_parsed, stored
from jausml.authoring.editing.splices import common_ends
from jausml.language.model import refs
from jausml.language.model.library import library_root
from jausml.language.text.tree import Span

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.editing.splices import Splice
    from jausml.authoring.editor.workbench import Workbench
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.reading.reader import ReadResult
    from jausml.language.model.refs import Ref


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of a text."""

    path: Path
    span: Span
    text: str


class Unsaved:
    """Some texts as somebody holds them.

    Args:
        texts: The texts by real path. What they refer to besides is read where it is stored.
    """

    def __init__(self, texts: Mapping[Path, str]) -> None:
        self.root = Path(os.path.commonpath([each.parent for each in texts]))
        self._names = {path: path.relative_to(self.root).as_posix() for path in texts}
        self._texts = texts
        self._files = {
            name: stored(name, texts[path].encode(), 0) for path, name in self._names.items()
        }
        self._reader = Reader(self.root)

    def read(self, path: Path) -> ReadResult:
        """Returns the model of a text and all that it refers to."""
        return self._reader.read(self._names[path], self._files)

    def ref(self, path: Path, find: Callable[[Model], EObject | None]) -> Ref:
        """Returns the ref of an element of a text, empty where there is none."""
        model = self.read(path).model
        return refs.ref_of(find(model), model, self.root)

    def edits(self, path: Path, commands: Sequence[Command]) -> list[Edit]:
        """Returns what commands would change.

        Args:
            path: The text that they begin with, which has to be sound.

        Raises:
            EditError: They cannot be carried out.
        """
        name = self._names[path]
        if not can_be_parsed(name, self._files[name].data):
            raise EditError(f"{name} cannot be parsed as it is: fix it first")
        draft = Draft(self.root, self._files, self._reader, 1)
        execute(commands, draft)
        steps = {each.file: each.steps for each in draft.changes()}
        return [
            edit
            for file, of_file in self._names.items()
            if of_file in steps
            for edit in self._edits(file, steps[of_file], draft.files[of_file].data.decode())
        ]

    def _edits(self, path: Path, steps: Sequence[Sequence[Splice]], new: str) -> Iterator[Edit]:
        text = self._texts[path]
        if len(steps) == 1:
            data = text.encode()
            for each in steps[0]:
                before, old = data[: each.start].decode(), each.old.decode()
                yield _edit(path, text, len(before), len(old), each.new.decode())
        else:
            # Later steps count in what the earlier ones have made.
            front, back = common_ends(text, new)
            size = len(text) - back - front
            yield _edit(path, text, front, size, new[front : len(new) - back])


def _edit(path: Path, text: str, start: int, size: int, new: str) -> Edit:
    (line, column), (end_line, end_column) = (
        (before.count("\n") + 1, len(before) - before.rfind("\n"))
        for before in (text[:start], text[: start + size])
    )
    return Edit(path, Span(line, column, end_line, end_column), new)


def unsaved(bench: Workbench, path: Path) -> Unsaved:
    """Returns a text, the open ones and what these import, as an editor holds them."""
    return Unsaved({each: bench.text(each) for each in bench.related(path) if not is_shipped(each)})


def is_shipped(path: Path) -> bool:
    """Tells whether a file is one of the library, which nobody changes."""
    return path.is_relative_to(library_root().resolve())
