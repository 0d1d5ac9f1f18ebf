"""Targets: what each declares of itself, and how they are found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from jausml.generation.errors import GenerationError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from jausml.generation.tasks import Task

ENTRY_POINT_GROUP = "jausml.targets"

ModelT = TypeVar("ModelT")


@dataclass(frozen=True)
class WholeLibrary(Generic[ModelT]):
    """That a target can describe more than a system uses (`--all`)."""

    help: str
    tasks: Callable[[ModelT], Sequence[Task]]


@dataclass(frozen=True)
class Target(Generic[ModelT]):
    """One kind of output, in a folder of its own with views and templates.

    Attributes:
        is_on_request: Whether it runs only when it is named: what it makes is no part of the
            workspace.
        is_shared: Whether its files are the same for every model; those of a workspace share them.
        whole_library: What it does with `--all`, or None when it has no such option.
        processes: Returns what `jausml run` starts, as the manifest records it; None for a target
            that knows no processes.
    """

    name: str
    description: str
    tasks: Callable[[ModelT], Sequence[Task]]
    template_folders: tuple[Path, ...] = ()
    is_on_request: bool = False
    is_renewed: bool = False
    is_shared: bool = False
    needs_system: bool = True
    whole_library: WholeLibrary[ModelT] | None = None
    processes: Callable[[ModelT], Sequence[Mapping[str, Any]]] | None = None

    def for_whole_library(self) -> Target[ModelT]:
        """Returns the target as `--all` asks for it, or itself when it has no such option."""
        return replace(self, tasks=self.whole_library.tasks) if self.whole_library else self


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
        target = entry.load()
    except Exception as error:
        raise GenerationError(f"target '{entry.name}' ({entry.value}): {error}") from error
    if not isinstance(target, Target):
        raise GenerationError(f"target '{entry.name}' ({entry.value}) is no Target")
    if target.name != entry.name:
        raise GenerationError(f"target '{entry.name}' ({entry.value}) calls itself '{target.name}'")
    return target
