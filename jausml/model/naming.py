"""Finds classes by the qualified names that documents use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.model.values import show, suggest

if TYPE_CHECKING:
    from jausml.metamodel import ClassTable, Metamodels, PackageTable
    from jausml.model.documents import Document
    from jausml.model.parsing import Node
    from jausml.model.problems import Attribute, Problems

XSI = "http://www.w3.org/2001/XMLSchema-instance"
XML = "http://www.w3.org/XML/1998/namespace"
ECORE = "http://www.eclipse.org/emf/2002/Ecore"
_XMI_PREFIXES = (
    "http://www.omg.org/XMI",
    "http://www.omg.org/spec/XMI/",
    "http://schema.omg.org/spec/XMI/",
)


def is_xmi(namespace: str) -> bool:
    """Tells whether a namespace is one of the versions of XMI."""
    return namespace.startswith(_XMI_PREFIXES)


class ClassFinder:
    """Finds classes, and reports names that stand for none."""

    def __init__(self, metamodels: Metamodels, problems: Problems) -> None:
        self._metamodels = metamodels
        self._problems = problems

    def of_root(self, document: Document, node: Node) -> ClassTable | None:
        """Returns the class of a root element, which its tag names."""
        if not node.namespace:
            names = ", ".join(sorted(p.name for p in self._metamodels.packages.values()))
            self._problems.at_node(
                "JML101",
                document,
                node,
                f"root element {show(node.tag)} has no namespace",
                f"write the prefix of its metamodel ({names}) and declare it by xmlns",
            )
            return None
        package = self._package(document, node, node.namespace, None)
        return self._class(document, node, package, node.tag, None) if package else None

    def of_type(
        self, document: Document, node: Node, written: str, attribute: Attribute
    ) -> ClassTable | None:
        """Returns the class that xsi:type (or xmi:type) names."""
        prefix, _, name = written.strip().rpartition(":")
        namespace = node.prefixes.get(prefix)
        if not namespace:
            what = f"prefix '{prefix}' of {show(written)} is not declared"
            known = [each.name for each in self._metamodels.packages.values()]
            hint = f'declare xmlns:{prefix}="..." on the root element'
            if not prefix:
                what, hint = f"{show(written)} has no prefix", f"write one of {', '.join(known)}"
            self._problems.at_node("JML101", document, node, what, hint, attribute=attribute)
            return None
        package = self._package(document, node, namespace, attribute)
        return self._class(document, node, package, name, attribute) if package else None

    def _package(
        self, document: Document, node: Node, namespace: str, attribute: Attribute | None
    ) -> PackageTable | None:
        package = self._metamodels.packages.get(namespace)
        if package is None:
            self._problems.at_node(
                "JML101",
                document,
                node,
                f"unknown namespace '{namespace}'",
                self._namespace_hint(namespace),
                attribute=attribute,
            )
        return package

    def _namespace_hint(self, namespace: str) -> str:
        if namespace == ECORE:
            return "this is a metamodel, not a model"
        family = namespace.rpartition("/")[0]
        for known in self._metamodels.packages:
            if family and known.rpartition("/")[0] == family:
                ours, theirs = known.rpartition("/")[2], namespace.rpartition("/")[2]
                return f"the model is for version {theirs}, this tool reads version {ours}"
        return suggest(namespace, list(self._metamodels.packages)) or "known are " + ", ".join(
            sorted(self._metamodels.packages)
        )

    def _class(
        self,
        document: Document,
        node: Node,
        package: PackageTable,
        name: str,
        attribute: Attribute | None,
    ) -> ClassTable | None:
        table = package.classes.get(name)
        if table is None:
            self._problems.at_node(
                "JML102",
                document,
                node,
                f"unknown class {show(name)} of the {package.name} metamodel",
                suggest(name, list(package.classes)),
                attribute=attribute,
            )
        return table


def concrete_names(table: ClassTable) -> str:
    """Returns the names of the classes that can stand for an abstract one, for a hint."""
    names = sorted(each.qualified_name for each in table.subtypes if not each.abstract)
    return ", ".join(name.replace(".", ":") for name in names)
