"""Subject of the rules: a model, and which of its elements were read without an error."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, TypeVar

from jausml.metamodel.classes import jaus, ros
from jausml.model.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from jausml.metamodel.classes.ecore import EClass, EObject
    from jausml.model.model import Model

ElementT = TypeVar("ElementT", bound="EObject")
Fact = TypeVar("Fact")


class Subject:
    """A model as rules see it.

    Elements that the reader complained about stay out of sight, so that one cause is one error.
    So does the shipped library, unless the user named one of its files.

    Args:
        model: The model.
        diagnostics: What the reader found.
    """

    def __init__(self, model: Model, diagnostics: Iterable[Diagnostic] = ()) -> None:
        self.model = model
        self._by_class: dict[EClass, list[tuple[int, Any]]] = defaultdict(list)
        self._count = 0
        self._broken: set[EObject] = set()
        self._damaged: set[EObject] = set()
        self._facts: dict[Any, Any] = {}
        errors = {
            (each.location.path, each.fragment)
            for each in diagnostics
            if each.severity is Severity.ERROR and each.fragment
        }
        for document in model.documents:
            is_checked = document.given or not document.is_library
            files_errors = {fragment for path, fragment in errors if path == document.display}
            if is_checked or files_errors:
                self._index(document.roots, files_errors, is_checked=is_checked)

    def _index(self, roots: list[EObject], errors: set[str], *, is_checked: bool) -> None:
        pending = list(reversed(roots))
        while pending:
            element = pending.pop()
            if is_checked:
                self._by_class[element.eClass].append((self._count, element))
                self._count += 1
            if errors and self.model.fragment(element) in errors:
                self._mark(element)
            pending.extend(reversed(self.model.owned(element)))

    def _mark(self, element: EObject) -> None:
        self._broken.add(element)
        around: EObject | None = element
        while around is not None:
            self._damaged.add(around)
            around = around.eContainer()

    def instances(self, kind: type[ElementT]) -> list[ElementT]:
        """Returns the sound elements of a class and of the classes that specialise it.

        Args:
            kind: The class, such as `jaus.Component`.

        Returns:
            The elements in document order.
        """
        subtypes = self.model.metamodels.class_of(kind).subtypes
        found = [pair for table in subtypes for pair in self._by_class.get(table.eclass, ())]
        found.sort(key=lambda pair: pair[0])
        return [element for _, element in found if element not in self._broken]

    def once(self, find: Callable[[Subject], Fact]) -> Fact:
        """Returns facts that several rules need, which are found when first asked for.

        Args:
            find: Finds them.
        """
        if find not in self._facts:
            self._facts[find] = find(self)
        found: Fact = self._facts[find]
        return found

    def is_broken(self, element: EObject) -> bool:
        """Tells whether the reader found an error in the features of an element itself."""
        return element in self._broken

    def is_intact(self, *elements: EObject | None) -> bool:
        """Tells whether elements are there and were read without an error, contents included."""
        return all(each is not None and each not in self._damaged for each in elements)

    def severity(self, element: EObject) -> Severity | None:
        """Returns how grave a fault of an element's definition is: a warning in the library.

        The library has the published services as they are. Whoever uses them cannot mend them,
        and the other messages of the service are as good as any.

        Returns:
            Warning, or None where the rule decides.
        """
        return Severity.WARNING if self.model.is_library(element) else None

    def assigned(self, element: EObject, values: Mapping[str, str]) -> str:
        """Returns how the document of an element gives its features values, for a hint.

        Args:
            element: The element.
            values: The values by feature.
        """
        document = self.model.document_of(element)
        is_text = document is not None and document.notation is not None
        form = "{}: {}" if is_text else '{}="{}"'
        return " ".join(form.format(name, value) for name, value in values.items())

    def path(self, element: EObject) -> str:
        """Returns how messages name an element that stands elsewhere."""
        return self.model.element_path(element)

    def systems(self) -> list[list[jaus.Component | ros.Node]]:
        """Returns the components (bridges included) and nodes that live together.

        They are those of one system; those without a system live together too.
        """
        groups: dict[EObject | None, list[jaus.Component | ros.Node]] = defaultdict(list)
        for component in self.instances(jaus.Component):
            groups[component.eContainer()].append(component)
        for node in self.instances(ros.Node):
            groups[node.eContainer()].append(node)
        return list(groups.values())
