"""Package files of an ament_python package, and what its code may import of the runtime."""

from __future__ import annotations

import ast
import functools
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import jausml
from jausml.generation import native
from jausml.generation.artifact import Kind, SkeletonContract
from jausml.generation.literals import LINE_WIDTH, python_string
from jausml.generation.python import Imports, Origin, layout, offered
from jausml.generation.target import FileTask, Task, TextFile, TextTask, templates_beside
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.system import System
from jausml_generators.python.names import Scope, class_name, package_name

API_VERSION = (1, 0)
"""API of the runtime that generated code is written for."""

FACE = "jausml_runtime"
"""Components, bridges, and what they are made and told of."""
MESSAGES = f"{FACE}.messages"
"""Messages of the core services."""
CONVERSIONS = f"{FACE}.conversions"
"""Conversions of values, and the values that they know."""
LIGHT = f"{FACE}.bridge.light_message"
"""The module of the parts of light classes of ROS messages."""
OCTETS = f"{FACE}.bridge.messages.octets"
"""Lists of single octets."""
VALUES = f"{FACE}.bridge.ros.values"
"""Checks of what nodes publish and answer."""
WIRE = f"{FACE}.wire"
"""The module of the parts of message classes."""


@functools.cache
def runtime_names() -> Mapping[str, Origin]:
    """Returns the names of the runtime for generated modules, besides messages and codecs.

    The face is read from the file that is copied: nothing that generates imports the runtime.
    """
    face = Path(jausml.__file__).parent / "runtime" / "__init__.py"
    names = [
        alias.name
        for node in ast.parse(face.read_text("utf-8")).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    return {
        **offered(FACE, *names),
        "conversions": Origin(FACE, "conversions"),
        "arithmetic": Origin(CONVERSIONS, "arithmetic"),
        "octets": Origin(f"{FACE}.bridge.messages", "octets"),
    }


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
        """Whether it imports the runtime, and its programs do not ask for the API themselves."""
        return FACE in self.dependencies and not self.executables

    @property
    def runtime_api(self) -> tuple[int, int]:
        """API of the runtime that its code is written for."""
        return API_VERSION

    @property
    def core_flags(self) -> str:
        """How the core is compiled, as Python text; setuptools itself makes it a library."""
        own = [flag for flag in native.FLAGS if flag not in {"-shared", "-fPIC"}]
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
        return API_VERSION


class ProgramView(ABC):
    """A component, bridge or node whose package holds a base, a skeleton and an entry point.

    Attributes:
        KIND: What its identity begins with.
        source: Model file.
    """

    KIND: ClassVar[str]
    source: str

    @property
    @abstractmethod
    def element(self) -> jaus.Component | ros.Node:
        """The model element."""

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"{self.KIND}:{self.element.name}"

    @property
    def name(self) -> str:
        """Its name in the model."""
        return str(self.element.name)

    @property
    def package(self) -> str:
        """Package, module of the skeleton and executable."""
        return package_name(str(self.element.name))

    @functools.cached_property
    def class_name(self) -> str:
        """Class of the user's skeleton, which hides no class that its modules import."""
        name = class_name("".join(word.capitalize() for word in self.package.split("_")))
        hidden = {*self.imported, *(other.removesuffix("Base") for other in self.imported)}
        return Scope(frozenset(hidden)).claim(name, f"{name}{self.KIND.capitalize()}")

    @property
    def imported(self) -> Collection[str]:
        """Names that its modules may import."""
        return runtime_names()

    @property
    def base_name(self) -> str:
        """Class that is generated anew each time."""
        return f"{self.class_name}Base"

    @property
    @abstractmethod
    def entry_point(self) -> EntryPoint:
        """How its process runs."""

    @abstractmethod
    def contract(self) -> SkeletonContract:
        """Returns the methods that the base expects of the user's class."""

    @property
    @abstractmethod
    def base_imports(self) -> Imports:
        """The names that the base may import."""

    @property
    @abstractmethod
    def skeleton_imports(self) -> Imports:
        """The names that the skeleton may import."""

    def package_view(self, system: System, description: str, **attributes: Any) -> PackageView:
        """Returns its package; other attributes are those of `package_view`."""
        return package_view(
            system,
            self.package,
            element_id=self.element_id,
            source=self.source,
            description=description,
            element=self.element,
            executables=((self.package, f"{self.package}.main"),),
            **attributes,
        )


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
    """Returns a method for users to paste, laid out as in its class."""
    if all(len(line) <= LINE_WIDTH for line in stub.split("\n")):
        return stub
    return layout(f"class _:\n{stub}").partition("\n")[2]


def _text(package: PackageView, path: str) -> TextFile:
    return TextFile(f"{package.name}/{path}", "", package.element_id, package.source)
