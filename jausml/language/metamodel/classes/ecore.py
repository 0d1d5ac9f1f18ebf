"""Common part of all elements of models: pyecore's own classes."""

from pyecore.ecore import EClass, EEnumLiteral, EObject, EPackage, EStructuralFeature

__all__ = ["EClass", "EEnumLiteral", "EObject", "EPackage", "EStructuralFeature"]
