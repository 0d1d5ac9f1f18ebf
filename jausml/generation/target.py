"""Generator targets and how they are found."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, runtime_checkable

from jausml.generation.errors import GenerationError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.generation.engine import ArtifactTask

ENTRY_POINT_GROUP = "jausml.targets"

ModelT_contra = TypeVar("ModelT_contra", contravariant=True)


class Target(Protocol[ModelT_contra]):
    """One kind of output, in a folder of its own with views and templates."""

    @property
    def name(self) -> str:
        """The name on the command line, equal to the name of the entry point."""

    @property
    def description(self) -> str:
        """One line for the list of targets."""

    @property
    def template_folders(self) -> Sequence[Path]:
        """Folders of templates in search order; empty when there are none."""

    def tasks(self, model: ModelT_contra) -> Sequence[ArtifactTask[Any]]:
        """Returns the files to be made for a model, as fresh tasks.

        Args:
            model: A valid model.
        """


@runtime_checkable
class LibraryTarget(Protocol):
    """A target that can describe the shipped library instead of what a system uses of it."""

    def for_whole_library(self) -> Target[Any]:
        """Returns the target that does."""


def is_on_request(target: Target[Any]) -> bool:
    """Tells whether a target runs only when it is named.

    Such a target says so by an attribute `is_on_request`: what it makes is no part of the
    workspace.

    Args:
        target: An installed target.
    """
    return bool(getattr(target, "is_on_request", False))


def needs_system(target: Target[Any]) -> bool:
    """Tells whether a target makes something of a system alone.

    One that is content with messages or types says so by an attribute `needs_system = False`.

    Args:
        target: An installed target.
    """
    return bool(getattr(target, "needs_system", True))


def load_targets() -> dict[str, Target[Any]]:
    """Returns the installed targets (entry points `jausml.targets`), sorted by name.

    Raises:
        GenerationError: A target cannot be loaded, or two have one name.
    """
    targets: dict[str, Target[Any]] = {}
    found = entry_points(group=ENTRY_POINT_GROUP)
    for entry in sorted(found, key=lambda entry: (entry.name, entry.value)):
        if entry.name in targets:
            raise GenerationError(f"two installed targets have the name '{entry.name}'")
        targets[entry.name] = _load(entry)
    return targets


def _load(entry: EntryPoint) -> Target[Any]:
    try:
        target: Target[Any] = entry.load()
        name = target.name
    except Exception as error:
        raise GenerationError(f"target '{entry.name}' ({entry.value}): {error}") from error
    if name != entry.name:
        raise GenerationError(f"target '{entry.name}' ({entry.value}) calls itself '{name}'")
    return target
