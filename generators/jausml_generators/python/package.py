"""Package files: what makes a folder an ament_python package, shared by all targets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from jausml.generation import native
from jausml.generation.artifact import Kind
from jausml.generation.languages.python import Imports, layout
from jausml.generation.literals import python_string
from jausml.generation.target import FileTask, Task, TextFile, TextTask, templates_beside
from jausml_generators.common import runtime

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Sequence

    from jausml.generation.artifact import SkeletonContract
    from jausml.language.metamodel.classes import jaus, ros
    from jausml.language.metamodel.classes.system import System

PACKAGE_TEMPLATES = templates_beside(__file__)
"""Folder of the shared templates, for the `template_folders` of a target."""


@dataclass(frozen=True)
class PackageView:
    """An ament_python package.

    Attributes:
        dependencies: Packages that it needs at run time, sorted.
        core: Source of its compiled core; empty without one.
    """

    name: str
    element_id: str
    source: str
    description: str
    version: str
    maintainer: str
    maintainer_email: str
    license: str
    dependencies: tuple[str, ...] = ()
    test_dependencies: tuple[str, ...] = ("python3-pytest",)
    executables: tuple[tuple[str, str], ...] = ()
    data: tuple[tuple[str, str], ...] = ()
    python: bool = True
    has_own_init: bool = False
    core: str = ""

    @property
    def asks_for_api(self) -> bool:
        """Whether it imports the runtime, and what is run in it does not ask for its API."""
        return runtime.FACE in self.dependencies and not self.executables

    @property
    def runtime_api(self) -> tuple[int, int]:
        """API of the runtime that its code is written for."""
        return runtime.API_VERSION

    @property
    def core_flags(self) -> str:
        """How the core is compiled, as Python text; setuptools itself makes it a library."""
        own = [each for each in native.FLAGS if each not in {"-shared", "-fPIC"}]
        return f"[{', '.join(map(python_string, own))}]"


def package_view(
    system: System,
    name: str,
    *,
    dependencies: Iterable[str],
    element: jaus.Component | ros.Node | None = None,
    **attributes: Any,
) -> PackageView:
    """Returns the package of an element of a system, with the system's version and maintainer.

    Args:
        element: The component or node; what its skeleton needs joins the dependencies.
        **attributes: The other attributes of PackageView; they precede what the system says.
    """
    metadata = {
        "version": system.version,
        "maintainer": system.maintainer,
        "maintainer_email": system.maintainerEmail,
        "license": system.license,
    }
    needed = {*dependencies, *(element.dependencies if element is not None else ())}
    return PackageView(name=name, dependencies=tuple(sorted(needed)), **{**metadata, **attributes})


def package_tasks(packages: Sequence[PackageView]) -> list[Task]:
    """Returns the tasks for package.xml, setup.py, setup.cfg, `__init__.py` and empty markers."""
    with_code = [package for package in packages if package.python]
    markers = [_text(package, f"resource/{package.name}") for package in packages]
    markers += [_text(package, f"{package.name}/py.typed") for package in with_code]
    return [
        FileTask("package.xml.j2", packages, lambda package: f"{package.name}/package.xml"),
        FileTask("setup.py.j2", packages, lambda package: f"{package.name}/setup.py"),
        FileTask("setup.cfg.j2", packages, lambda package: f"{package.name}/setup.cfg"),
        FileTask(
            "init.py.j2",
            [package for package in with_code if not package.has_own_init],
            lambda package: f"{package.name}/{package.name}/__init__.py",
        ),
        TextTask(markers),
    ]


@dataclass(frozen=True)
class EntryPoint:
    """How the module `main` of a package runs the user's class."""

    title: str
    runner: str
    arguments: str
    end: str
    needs_program: bool = False

    @property
    def runtime_api(self) -> tuple[int, int]:
        """API of the runtime that the generated code is written for."""
        return runtime.API_VERSION


class ProgramView(Protocol):
    """A component, bridge or node whose package holds a base, a skeleton and an entry point."""

    @property
    def element_id(self) -> str:
        """Identity of the model element."""

    @property
    def source(self) -> str:
        """Model file."""

    @property
    def package(self) -> str:
        """Package name, which is also the name of the skeleton's module."""

    @property
    def class_name(self) -> str:
        """The user's class."""

    @property
    def entry_point(self) -> EntryPoint:
        """How its process runs."""

    def contract(self) -> SkeletonContract:
        """Returns what the base expects of the user's class."""

    @property
    def base_imports(self) -> Imports:
        """What the base may import."""

    @property
    def skeleton_imports(self) -> Imports:
        """What the skeleton may import."""


ViewT = TypeVar("ViewT", bound=ProgramView)


def module_path(view: ProgramView, name: str) -> str:
    """Returns the path of a module of a package."""
    return f"{view.package}/{view.package}/{name}.py"


def program_tasks(
    views: Sequence[ViewT],
    *,
    base: str,
    skeleton: str,
    words: Callable[[ViewT], Collection[str]] | None = None,
) -> list[Task]:
    """Returns the tasks for what runs: the base, the user's skeleton and the entry point."""
    return [
        FileTask(
            base,
            views,
            lambda view: module_path(view, f"{view.package}_base"),
            imports=lambda view: view.base_imports,
            words=words,
        ),
        FileTask(
            skeleton,
            views,
            lambda view: module_path(view, view.package),
            kind=Kind.SKELETON,
            contract=lambda view: view.contract(),
            imports=lambda view: view.skeleton_imports,
        ),
        FileTask(
            "main.py.j2",
            views,
            lambda view: module_path(view, "main"),
            imports=lambda _: Imports({}),
        ),
    ]


def laid_out(stub: str) -> str:
    """Returns a method that users may paste, laid out as it stands in its class."""
    return layout(f"class _:\n{stub}").partition("\n")[2]


def _text(package: PackageView, path: str) -> TextFile:
    return TextFile(f"{package.name}/{path}", "", package.element_id, package.source)
