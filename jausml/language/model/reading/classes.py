"""Demands of a metamodel on a document: classes by qualified names, and bounds of features."""

from __future__ import annotations

from collections.abc import Iterable
from typing import cast

from jausml.language.metamodel import (
    ClassTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
    PackageTable,
)
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import count
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.reading.problems import NodePlace, ReadingProblems
from jausml.language.model.values import show, suggest
from jausml.language.model.xmi.parsing import Node
from jausml.language.model.xmi.printing import XSI

ECORE = "http://www.eclipse.org/emf/2002/Ecore"
_XMI_NAMESPACES = (
    "http://www.omg.org/XMI",
    "http://www.omg.org/spec/XMI/",
    "http://schema.omg.org/spec/XMI/",
)


def is_xmi(namespace: str) -> bool:
    """Tells whether a namespace is one of the versions of XMI."""
    return namespace.startswith(_XMI_NAMESPACES)


def target_class(feature: FeatureTable) -> ClassTable:
    """Returns the class of a reference."""
    return cast("ClassTable", feature.target)


class ClassFinder:
    """Finds the classes that one document names, and reports names that stand for none."""

    def __init__(
        self, metamodels: Metamodels, problems: ReadingProblems, document: Document
    ) -> None:
        self._metamodels = metamodels
        self._problems = problems
        self._document = document

    def of_root(self, node: Node) -> ClassTable | None:
        """Returns the class of a root element, which its tag names."""
        place = NodePlace(self._document, node)
        if not node.namespace:
            names = ", ".join(
                sorted(package_table.name for package_table in self._metamodels.packages.values())
            )
            self._problems.report(
                "JML101",
                place,
                f"root element {show(node.tag)} has no namespace",
                f"write the prefix of its metamodel ({names}) and declare it by xmlns",
            )
            return None
        package = self._package(place, node.namespace)
        table = self._class(place, package, node.tag) if package is not None else None
        return table if table is not None and self._is_concrete(place, table) else None

    def check_schema_location(self, root: Node) -> None:
        """Reports metamodels of other files than those that are used."""
        words = (root.get(f"{XSI} schemaLocation") or "").split()
        for namespace, place in zip(words[::2], words[1::2], strict=False):
            package = self._metamodels.packages.get(namespace)
            file_name = place.partition("#")[0].rpartition("/")[2]
            if package is not None and file_name != package.file_name:
                message = f"schemaLocation names {show(place)} for {namespace}"
                hint = f"jausml uses its own {package.file_name}"
                at = NodePlace(self._document, root, (XSI, "schemaLocation"))
                self._problems.report("JML010", at, message, hint)

    def check_prefixes(self, node: Node) -> None:
        """Reports other prefixes than xsi and xmi: EMF knows these alone."""
        # Any other prefix is right XML, but EMF looks for these two by their names.
        for prefix, belongs in (("xsi", XSI.__eq__), ("xmi", is_xmi)):
            other = [name for name, uri in node.prefixes.items() if belongs(uri)]
            if other and prefix not in other:
                message = f"Eclipse does not take prefix '{other[0]}' for '{prefix}'"
                place = NodePlace(self._document, node)
                hint = f"rename '{other[0]}' to '{prefix}'"
                self._problems.report("JML013", place, message, hint)

    def of_feature(self, node: Node, feature: FeatureTable, owner: Node) -> ClassTable | None:
        """Returns the class of a child element: that of xsi:type, else that of the feature.

        Returns:
            A class that fits the feature and is not abstract, or None after a report.
        """
        table = target_class(feature)
        attribute = _type_attribute(node)
        if attribute is None and not table.abstract:
            return table
        written = "" if attribute is None else node.get(" ".join(attribute)) or ""
        # Sound cases are decided here without a report; what follows only finds the right one.
        named = self._known(node, written)
        if named is not None and named in table.subtypes and not named.abstract:
            return named
        place = NodePlace(self._document, node, attribute)
        if attribute is not None:
            named = named or self.of_name(place, written)
            if named is None:
                return None
            if named not in table.subtypes:
                self._problems.report(
                    "JML113",
                    place,
                    f"{named.qualified_name} is no {feature.type_name}, which feature"
                    f" '{feature.name}' of {owner.obj.eClass.name} takes",
                    f"write {concrete_names(table)}",
                )
                return None
            table = named
        return table if self._is_concrete(place, table) else None

    def _known(self, node: Node, written: str) -> ClassTable | None:
        prefix, _, name = written.strip().rpartition(":")
        package = self._metamodels.packages.get(node.prefixes.get(prefix, ""))
        return None if package is None else package.classes.get(name)

    def of_name(self, place: NodePlace, written: str) -> ClassTable | None:
        """Returns the class of a qualified name such as `jaus:Component`."""
        prefix, _, name = written.strip().rpartition(":")
        namespace = place.node.prefixes.get(prefix)
        if not namespace:
            known = sorted(table.name for table in self._metamodels.packages.values())
            message = f"prefix '{prefix}' of {show(written)} is not declared"
            hint = f'declare xmlns:{prefix}="..." on the root element'
            if not prefix:
                message, hint = f"{show(written)} has no prefix", f"write {', '.join(known)}"
            self._problems.report("JML101", place, message, hint)
            return None
        package = self._package(place, namespace)
        return self._class(place, package, name) if package is not None else None

    def _package(self, place: NodePlace, namespace: str) -> PackageTable | None:
        package = self._metamodels.packages.get(namespace)
        if package is None:
            message = f"unknown namespace '{namespace}'"
            self._problems.report("JML101", place, message, self._namespace_hint(namespace))
        return package

    def _namespace_hint(self, namespace: str) -> str:
        if namespace == ECORE:
            return "this is a metamodel, not a model"
        # The last part of a namespace is the version, so the same rest is another version of it.
        family, _, theirs = namespace.rpartition("/")
        for known in self._metamodels.packages:
            if family and known.rpartition("/")[0] == family:
                ours = known.rpartition("/")[2]
                return f"the model is for version {theirs}, this tool reads version {ours}"
        known_names = sorted(self._metamodels.packages)
        return suggest(namespace, known_names) or f"known are {', '.join(known_names)}"

    def _class(self, place: NodePlace, package: PackageTable, name: str) -> ClassTable | None:
        table = package.classes.get(name)
        if table is None:
            message = f"unknown class {show(name)} of the {package.name} metamodel"
            self._problems.report("JML102", place, message, suggest(name, package.classes))
        return table

    def _is_concrete(self, place: NodePlace, table: ClassTable) -> bool:
        if table.abstract:
            hint = f"name a concrete class by xsi:type: {concrete_names(table)}"
            message = f"class {table.qualified_name} is abstract"
            self._problems.report("JML104", place, message, hint)
        return not table.abstract


def concrete_names(table: ClassTable) -> str:
    """Returns the names of the classes that can stand for a class, for a hint."""
    names = sorted(subtype.qualified_name for subtype in table.subtypes if not subtype.abstract)
    return ", ".join(name.replace(".", ":") for name in names)


def _type_attribute(node: Node) -> tuple[str, str] | None:
    """Returns namespace and name of the xsi:type or xmi:type of an element, if it has one."""
    for name in node.attributes[::2]:
        if name.endswith(" type"):
            namespace = name[: -len(" type")]
            if namespace == XSI or is_xmi(namespace):
                return namespace, "type"
    return None


def check_bounds(documents: Iterable[Document], model: Model, problems: ReadingProblems) -> None:
    """Checks the lower and upper bounds of all features of the elements of documents.

    A feature with another finding is left alone: one cause is one error.
    """
    for document in documents:
        pending = list(reversed(document.root_nodes))
        while pending:
            node = pending.pop()
            if node.obj is None:
                continue
            pending.extend(reversed(node.children))
            table = model.metamodels.class_of(node.obj)
            for feature in table.bounded:
                number = count(node.obj, feature)
                if number >= max(feature.lower, 1) and (
                    feature.upper < 0 or number <= feature.upper
                ):
                    continue
                if not problems.is_unread(node.obj, feature.name):
                    _report(document, node, table, feature, number, problems)


def _report(
    document: Document,
    node: Node,
    table: ClassTable,
    feature: FeatureTable,
    number: int,
    problems: ReadingProblems,
) -> None:
    # A later check of the same feature would report the same cause once more.
    problems.mark_unread(node.obj, feature.name)
    what = f"feature '{feature.name}' of {_label(table, node.obj)}"
    written = node.get(feature.name) is not None
    place = NodePlace(document, node, ("", feature.name) if written else None)
    if 0 <= feature.upper < number:
        message = f"{what} has {number} values, at most {feature.upper} are allowed"
        problems.report("JML109", place, message)
    elif number == 0 and feature.can_be_missing:
        message = f"required {what} is missing"
        notation = document.notation
        hint = _how(feature) if notation is None else notation.how_to_give(table, feature)
        problems.report("JML108", place, message, hint)
    elif 0 < number < feature.lower:
        message = f"{what} has {number} values, at least {feature.lower} are required"
        problems.report("JML110", place, message)


def _how(feature: FeatureTable) -> str:
    if feature.kind is FeatureKind.CONTAINMENT:
        return f"add a child element <{feature.name}> ({feature.type_name})"
    return f"it takes {'a reference to ' if feature.is_reference else ''}{feature.type_name}"


def _label(table: ClassTable, obj: EObject) -> str:
    name = getattr(obj, "name", None)
    return f"{table.name} '{name}'" if name else table.name
