"""What planners of notations are told, and what they give."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from jausml.language.model import refs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from jausml.authoring.editing.commands import ElementCommand
    from jausml.authoring.editing.splices import Splice
    from jausml.authoring.editing.working_copy import ElementCopy, WorkingCopy
    from jausml.language.metamodel import ClassTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model
    from jausml.language.model.refs import Ref


@dataclass(frozen=True)
class Context:
    """The file for which is planned, and the model that was read of it and all it refers to.

    Attributes:
        root: The opened folder, symbolic links followed.
        working_copy: The elements of all files concerned, as the commands will have them.
        paths: The paths of copies of the working copy before the commands.
    """

    file: str
    root: Path
    model: Model
    working_copy: WorkingCopy
    paths: Mapping[ElementCopy, str]
    locate: Callable[[Ref], tuple[EObject, Model]]

    @property
    def document(self) -> Document:
        """The document of the file."""
        return self.model.documents[0]

    def find(self, ref: Ref) -> EObject | None:
        """Returns the element of a ref, None when neither the file nor what it refers to has it."""
        return refs.find(ref, self.model, self.root)

    def ref(self, copy: ElementCopy) -> Ref:
        """Returns the ref of an element as it was read."""
        return f"{copy.file}#{self.working_copy.identifiers.get(copy) or self.paths[copy]}"

    def find_class(self, ref: Ref) -> ClassTable:
        """Returns the class of the element of a ref."""
        obj, model = self.locate(ref)
        return model.metamodels.class_of(obj)

    def is_own(self, obj: EObject | None) -> bool:
        """Tells whether an element stands in the file."""
        return self.model.document_of(obj) is self.document


class Planner(Protocol):
    """Plans changes of a file of one notation."""

    def __call__(self, commands: Sequence[ElementCommand], context: Context) -> list[Splice]:
        """Returns what is to change in one file so that commands hold.

        In the file that has an element of a command this is the change itself; in a file that
        refers to it, what that file says of it. What goes with an element that is removed was
        worked out before: it stands among the commands, as `Set` and `Remove` of their own.

        Args:
            commands: The commands, all of the same state of the files.

        Raises:
            UnwritableError: The notation cannot say what is wanted.
        """
