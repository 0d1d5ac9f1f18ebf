#!/usr/bin/env python3
"""Writes the stubs in jausml/language/metamodel/classes/ from the metamodels, for mypy.

Usage: python tools/build_model_types.py [FOLDER]
"""

from __future__ import annotations

import subprocess
import sys
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import jinja2
from multigen.jinja import JinjaGenerator
from pyecoregen.ecore import EcoreGenerator, EcorePackageModuleTask

from jausml.language.metamodel import (
    ClassTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
    PackageTable,
    ValueKind,
    documentation,
    load_metamodels,
)

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "jausml" / "language" / "metamodel" / "classes"

_INDENT = "    "
_WIDTH = 100
_QUOTES = '"""'
_PYTHON_TYPES = {
    ValueKind.STRING: "str",
    ValueKind.BOOLEAN: "bool",
    ValueKind.INTEGER: "int",
    ValueKind.REAL: "float",
}


@dataclass(frozen=True)
class FeatureView:
    """A feature as an attribute.

    Args:
        table: The feature.
        package: The package of its class.
    """

    table: FeatureTable
    package: PackageTable

    @property
    def name(self) -> str:
        """Name of the feature, which pyecore takes as it is."""
        return self.table.name

    @property
    def docstring(self) -> str:
        """What the metamodel says of it."""
        return _docstring(documentation(self.table.feature))

    @property
    def type(self) -> str:
        """What pyecore returns, in a model without errors: a required feature is there."""
        if self.table.many:
            return f"abc.Sequence[{self._single}]"
        return self._single if self._is_there else f"{self._single} | None"

    @property
    def _single(self) -> str:
        table = self.table
        if table.target is not None:
            return _reference(table.target, self.package)
        if table.data_type is None:
            raise ValueError(f"{table.name} has no type")
        return _PYTHON_TYPES.get(table.data_type.kind, table.data_type.name)

    @property
    def _is_there(self) -> bool:
        return self.table.lower > 0 or self.table.default is not None


@dataclass(frozen=True)
class ClassView:
    """A class of a metamodel.

    Args:
        table: The class.
        metamodels: All metamodels: a class of another language can own its elements.
    """

    table: ClassTable
    metamodels: Metamodels

    @property
    def name(self) -> str:
        """Name of the class."""
        return self.table.name

    @property
    def docstring(self) -> str:
        """What the metamodel says of it."""
        return _docstring(documentation(self.table.eclass))

    @property
    def supers(self) -> list[ClassTable]:
        """The classes that it specialises directly."""
        named = {
            (e_super_type.name, e_super_type.ePackage.nsURI)
            for e_super_type in self.table.eclass.eSuperTypes
        }
        class_tables = self.metamodels.classes.values()
        return [
            class_table
            for class_table in class_tables
            if (class_table.name, class_table.package.ns_uri) in named
        ]

    @property
    def bases(self) -> list[str]:
        """The same as Python names."""
        return [_reference(class_table, self.table.package) for class_table in self.supers] or [
            "EObject"
        ]

    @property
    def features(self) -> list[FeatureView]:
        """The features that the class itself declares."""
        own = self.table.eclass.eStructuralFeatures
        return [
            FeatureView(self.table.features[feature.name], self.table.package) for feature in own
        ]

    @property
    def owners(self) -> list[str]:
        """What owns its elements, as Python names."""
        return [_reference(owner_table, self.table.package) for owner_table in self.owner_tables]

    @property
    def owner_tables(self) -> list[ClassTable]:
        """The classes that own elements of this class, none when a superclass says so already."""
        inherited = [
            ClassView(class_table, self.metamodels).all_owners for class_table in self.supers
        ]
        return [] if self.all_owners in inherited else self.all_owners

    @cached_property
    def all_owners(self) -> list[ClassTable]:
        """The classes that own elements of this class; none for one that no feature can hold."""
        owners = []
        is_owned = False
        for owner in self.metamodels.classes.values():
            for feature in owner.eclass.eStructuralFeatures:
                table = owner.features[feature.name]
                if table.kind is not FeatureKind.CONTAINMENT or table.target is None:
                    continue
                is_owned |= table.target in self.table.supertypes
                if self.table in table.target.supertypes or table.target in self.table.supertypes:
                    owners.append(owner)
        return list(dict.fromkeys(owners)) if is_owned else []


@dataclass(frozen=True)
class EnumerationView:
    """An enumeration of a metamodel.

    Args:
        element: The EEnum.
    """

    element: Any

    @property
    def name(self) -> str:
        """Name of the enumeration."""
        return str(self.element.name)

    @property
    def docstring(self) -> str:
        """What the metamodel says of it."""
        return _docstring(documentation(self.element))

    @property
    def literals(self) -> list[str]:
        """Names of the literals."""
        return [e_literal.name for e_literal in self.element.eLiterals]


@dataclass(frozen=True)
class PackageView:
    """A metamodel.

    Args:
        table: The package.
        metamodels: All metamodels.
    """

    table: PackageTable
    metamodels: Metamodels

    @property
    def summary(self) -> str:
        """First line of the stub."""
        return f"The classes of the {self.table.name} language with their features."

    @property
    def file_name(self) -> str:
        """The metamodel's file."""
        return self.table.file_name

    @property
    def enumerations(self) -> list[EnumerationView]:
        """The enumerations in the order of the file."""
        named = self.table.enumerations
        return [EnumerationView(self.table.epackage.getEClassifier(name)) for name in named]

    @property
    def classes(self) -> list[ClassView]:
        """The classes in the order of the file."""
        return [
            ClassView(class_table, self.metamodels) for class_table in self.table.classes.values()
        ]

    @property
    def imports(self) -> list[str]:
        """The other languages that the stub names."""
        named = [
            table
            for view in self.classes
            for table in (
                *view.supers,
                *view.owner_tables,
                *(feature.table.target for feature in view.features),
            )
            if table is not None
        ]
        return sorted({class_table.package.name for class_table in named} - {self.table.name})


class StubTask(EcorePackageModuleTask):  # type: ignore[misc]  # pyecoregen has no types
    """Makes one stub of each metamodel."""

    template_name = "model_types.pyi.j2"

    @classmethod
    def folder_path_for_package(cls, package: Any) -> str:  # noqa: ARG003 - pyecoregen's
        """Returns no folder: the stubs stand beside each other."""
        return ""

    @staticmethod
    def filename_for_element(package: Any) -> str:
        """Returns the name of the stub."""
        return f"{package.name}.pyi"

    def create_template_context(self, element: Any, **_: object) -> dict[str, Any]:
        """Returns what the template sees."""
        metamodels = load_metamodels()
        return {"package": PackageView(metamodels.package_named(element.name), metamodels)}


class StubGenerator(EcoreGenerator):  # type: ignore[misc]  # pyecoregen has no types
    """Makes stubs in the place of pyecoregen's classes: elements stay pyecore's dynamic ones."""

    templates_path = str(Path(__file__).resolve().parent / "templates")

    def __init__(self) -> None:
        super().__init__()
        self.tasks = [StubTask(formatter=_formatted)]
        self.tasks[0].environment = self.create_environment()

    def create_environment(self, **kwargs: object) -> jinja2.Environment:
        """Returns an environment whose block lines leave nothing behind."""
        environment: jinja2.Environment = super().create_environment(
            trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True, **kwargs
        )
        return environment

    def generate(self, model: Any, outfolder: str) -> None:
        """Writes the stub of one metamodel.

        Without pyecoregen's renaming: the names of features are those that pyecore answers to.

        Args:
            model: The package.
            outfolder: The folder.
        """
        JinjaGenerator.generate(self, model, outfolder)


def build(folder: Path) -> list[Path]:
    """Writes the stubs.

    Args:
        folder: Where; it exists.

    Returns:
        The files.
    """
    generator = StubGenerator()
    packages = load_metamodels().packages.values()
    for package in packages:
        generator.generate(package.epackage, str(folder))
    return [folder / f"{package.name}.pyi" for package in packages]


def _reference(table: ClassTable, package: PackageTable) -> str:
    """Returns how a stub names a class, with the language when it is another one."""
    return table.name if table.package is package else table.qualified_name


def _docstring(text: str) -> str:
    """Returns a docstring of one sentence, and of the others below when it has more."""
    summary, _, rest = " ".join(text.split()).replace("\\", "\\\\").partition(". ")
    width = _WIDTH - len(_INDENT)
    if not rest:
        lines = textwrap.wrap(f"{_QUOTES}{summary}", width - len(_QUOTES))
        return f"\n{_INDENT}".join(lines) + _QUOTES
    lines = [*textwrap.wrap(f"{_QUOTES}{summary}.", width), "", *textwrap.wrap(rest, width)]
    return "\n".join(f"{_INDENT}{line}" if line else "" for line in [*lines, _QUOTES]).lstrip()


def _formatted(text: str) -> str:
    """Returns a stub in the layout that lint asks for."""
    command = [sys.executable, "-m", "ruff", "format", "--stdin-filename", "stub.pyi", "-"]
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=True, cwd=ROOT)
    return done.stdout


def main(arguments: Sequence[str]) -> int:
    """Runs the tool.

    Args:
        arguments: The folder, when it is another than the toolchain's.

    Returns:
        The exit code.
    """
    for path in build(Path(arguments[0]) if arguments else FOLDER):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
