"""The part of pyecore's reflection that the toolchain uses."""

from collections.abc import Iterator, Sequence
from typing import Any

class EPackage:
    """A metamodel."""

    name: str
    nsURI: str

class EStructuralFeature:
    """A feature of a class."""

    name: str
    many: bool

class EClass:
    """A class of a metamodel."""

    name: str
    ePackage: EPackage

    def eAllStructuralFeatures(self) -> Sequence[EStructuralFeature]: ...

class EEnumLiteral:
    """A literal of an enumeration."""

    @property
    def name(self) -> str:
        """The name by which models write it, the same as `literal` in these metamodels."""

    value: int

class EObject:
    """An element of a model, of any class."""

    eClass: EClass

    def eIsSet(self, feature: str) -> bool:
        """Whether a feature was given a value, be it the default."""

    def eContainer(self) -> EObject | None:
        """Returns the element that owns this one."""

    def eContainmentFeature(self) -> EStructuralFeature:
        """Returns the feature of the owner that holds this element."""

    def eAllContents(self) -> Iterator[EObject]:
        """Yields all that the element owns, in no particular order."""

    def eGet(self, feature: str) -> Any:
        """Returns the value of a feature by name."""
