"""Targets: what each declares of itself, the tasks it wants done, and the system they are for."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path, PurePath
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

from jausml.generation.artifact import Kind, SkeletonContract
from jausml.generation.errors import GenerationError, NoSystemError
from jausml.generation.python import Imports
from jausml.language.metamodel.classes import bridge, system
from jausml.language.model.model import Model


class View(Protocol):
    """The facts that a target's views module offers about one model element.

    A template asks it (as `view`) and computes nothing.
    """

    @property
    def element_id(self) -> str:
        """Identity of the model element, e.g. `component:vehicle`."""

    @property
    def source(self) -> str:
        """Model file it comes from, relative path."""


ViewT = TypeVar("ViewT", bound=View)


@dataclass(frozen=True)
class FileTask(Generic[ViewT]):
    """One file for each view, made from a template.

    Attributes:
        imports: For Python, what a file may import; its template has no import statements then.
        words: For Python, names in which functions and methods of a file may differ alone; where
            it has many that do, it is made faster.
    """

    template: str
    views: Sequence[ViewT]
    path: Callable[[ViewT], str]
    _: KW_ONLY
    kind: Kind = Kind.GENERATED
    executable: bool = False
    contract: Callable[[ViewT], SkeletonContract] | None = None
    imports: Callable[[ViewT], Imports] | None = None
    words: Callable[[ViewT], Collection[str]] | None = None

    def label(self, view: ViewT) -> str:
        """Returns the name for an error when no template line is known."""
        return f"{self.template} for {view.element_id}"


@dataclass(frozen=True)
class TextFile:
    """A file whose text is not made by a template, e.g. a copied module or a diagram."""

    path: str
    content: str
    element_id: str
    source: str


@dataclass(frozen=True)
class TextTask:
    """Files of ready text.

    Attributes:
        is_copied: What is copied from modules that run here need not be read to be believed.
    """

    views: Sequence[TextFile]
    _: KW_ONLY
    is_copied: bool = False
    kind: Kind = Kind.GENERATED
    executable: bool = False
    contract: Callable[[TextFile], SkeletonContract] | None = None

    @staticmethod
    def path(view: TextFile) -> str:
        """Returns the path of a file, relative to the output folder."""
        return view.path

    @staticmethod
    def label(view: TextFile) -> str:
        """Returns the name for an error."""
        return view.element_id


Task: TypeAlias = FileTask[Any] | TextTask


def templates_beside(module_file: str) -> Path:
    """Returns the folder `templates` beside a target's module."""
    return Path(module_file).resolve().parent / "templates"


ENTRY_POINT_GROUP = "jausml.targets"

ModelT = TypeVar("ModelT")


@dataclass(frozen=True)
class WholeLibrary(Generic[ModelT]):
    """A target's wider form, which describes more than a system uses (`--all`)."""

    help: str
    tasks: Callable[[ModelT], Sequence[Task]]


@dataclass(frozen=True)
class Target(Generic[ModelT]):
    """One kind of output, in a folder of its own with views and templates.

    Attributes:
        is_on_request: Whether it runs only when it is named: what it makes is no part of the
            workspace.
        is_shared: Whether its files are the same for every model; those of a workspace share them.
        for_code: Returns further tasks for Python in the workspace: path and text of each file.
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
    for_code: Callable[[Iterable[tuple[str, str]]], Sequence[Task]] | None = None
    needs_system: bool = True
    whole_library: WholeLibrary[ModelT] | None = None
    processes: Callable[[ModelT], Sequence[Mapping[str, Any]]] | None = None

    def for_whole_library(self) -> Target[ModelT]:
        """Returns the target as `--all` asks for it, or itself when it has no such option."""
        if self.whole_library is None:
            return self
        return replace(self, tasks=self.whole_library.tasks, for_code=None)


def load_targets() -> dict[str, Target[Any]]:
    """Returns the installed targets (entry points `jausml.targets`), sorted by name.

    Raises:
        GenerationError: A target cannot be loaded, or two have one name.
    """
    targets: dict[str, Target[Any]] = {}
    entries = entry_points(group=ENTRY_POINT_GROUP)
    for entry in sorted(entries, key=lambda entry: (entry.name, entry.value)):
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


def system_of(model: Model) -> system.System:
    """Returns the system of the file that is generated from.

    Systems of other files have their own workspaces; here they are only referred to.

    Raises:
        NoSystemError: There is none, or more than one: a workspace is made of one system.
    """
    document = model.documents[0]
    systems = [root for root in document.roots if isinstance(root, system.System)]
    if len(systems) != 1:
        maps = [
            str(mapping.name) for mapping in model.instances(bridge.AttributeMap, library=False)
        ]
        raise NoSystemError(document.display, [str(candidate.name) for candidate in systems], maps)
    return systems[0]


def name_of(model: Model) -> str:
    """Returns the name by which a workspace knows a model, wherever its file lies.

    It is that of its system; without one, e.g. with mere interface packages, that of its file.
    """
    document = model.documents[0]
    systems = [root for root in document.roots if isinstance(root, system.System)]
    return str(systems[0].name) if len(systems) == 1 else PurePath(document.display).stem


def source_of(model: Model) -> str:
    """Returns the name of the file that is generated from, without a path.

    The output is the same wherever the model lies.
    """
    return PurePath(model.documents[0].display).name
