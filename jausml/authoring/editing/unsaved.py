"""Edits of texts that others hold, such as an editor: planned and checked, never written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError, Rename
from jausml.authoring.editing.drafts import Draft
from jausml.authoring.editing.executing import execute
from jausml.authoring.editing.reading import Reader, can_be_parsed, stored
from jausml.language.model import refs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.authoring.editing.splices import Splice
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model
    from jausml.language.model.refs import Ref


class Unsaved:
    """Some model files as somebody holds them.

    Args:
        contents: The files by real path. What they refer to besides is read where it is stored.
    """

    def __init__(self, contents: Mapping[Path, bytes]) -> None:
        self._root = Path(os.path.commonpath([each.parent for each in contents]))
        names = {path: path.relative_to(self._root).as_posix() for path in contents}
        self._names = names
        files = {name: stored(name, contents[path], 0) for path, name in names.items()}
        self._draft = Draft(self._root, files, Reader(self._root), 1)

    def ref(self, path: Path, find: Callable[[Model], EObject | None]) -> Ref:
        """Returns the ref of an element of a file, empty where there is none."""
        model = self._draft.read(self._names[path]).model
        return refs.ref_of(find(model), model, self._root)

    def rename(self, element: Ref, name: str) -> Mapping[Path, Sequence[Splice]]:
        """Returns what another name of an element changes in each file."""
        home, _ = refs.split(element)
        if not can_be_parsed(home, self._draft.files[home].data):
            raise EditError(f"{home} cannot be parsed as it is: fix it first")
        execute([Rename(element, name)], self._draft)
        changed = {each.file: each.steps for each in self._draft.changes()}
        return {
            path: [splice for step in changed[name] for splice in step]
            for path, name in self._names.items()
            if name in changed
        }
