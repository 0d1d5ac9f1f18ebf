"""Builder of ROS elements that know where in the definition files they come from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from jausml.language.attributes.units import UnitError, parse_unit
from jausml.language.interfaces.parsing import PARTS
from jausml.language.metamodel import FeatureKind, ValueKind
from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.filling import link, new_object, set_value
from jausml.language.model.xmi.parsing import Node

if TYPE_CHECKING:
    from jausml.language.interfaces import Definition, FieldDefinition, Section
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model
    from jausml.language.semantics.installed import InterfaceType

_FEATURES = {"msg": "messages", "srv": "services", "action": "actions"}
ElementT = TypeVar("ElementT", bound="EObject")


@dataclass(frozen=True, slots=True)
class Use:
    """A field whose type is a message type that is still to be found."""

    element: ros.MessageField
    field: FieldDefinition
    owner: ros.MessageType
    package: str
    document: Document


class Builder:
    """Makes the elements of packages."""

    def __init__(self, model: Model, *, comments: bool) -> None:
        self._model = model
        self._with_comments = comments
        self.uses: list[Use] = []

    def package(self, name: str, document: Document | None) -> ros.InterfacePackage:
        """Makes a package."""
        package = self._new(ros.InterfacePackage, name=name)
        if document is not None:
            node = self._adopt(package, document, 1, 1)
            document.root_nodes.append(node)
        return package

    def interface(
        self,
        package: ros.InterfacePackage,
        name: str,
        kind: str,
        definition: Definition,
        document: Document,
    ) -> InterfaceType:
        """Makes a message, service or action and adds it to its package."""
        place = (package.name, document)
        element: InterfaceType
        if kind == "msg":
            element = self._message(name, definition.sections[0], *place)
        else:
            made: type[ros.ServiceType | ros.ActionType]
            made = ros.ServiceType if kind == "srv" else ros.ActionType
            element = self._new(made, name=name)
            self._adopt(element, document, 1, 1)
            head = definition.sections[0]
            self._document(element, head.comment)
            head.comment = ""
            for part, section in zip(PARTS[kind], definition.sections, strict=True):
                message = self._message(f"{name}_{part.capitalize()}", section, *place)
                self._set(element, part, message)
        self._set(package, _FEATURES[kind], element)
        return element

    def set(self, element: EObject, name: str, value: Any) -> None:
        """Sets a feature, or adds to one with many values."""
        self._set(element, name, value)

    def _message(
        self, name: str, section: Section, package: str, document: Document
    ) -> ros.MessageType:
        message = self._new(ros.MessageType, name=name)
        self._adopt(message, document, section.line, 1)
        self._document(message, section.comment)
        for field in section.fields:
            element = self._field(field)
            self._adopt(element, document, field.line, field.column)
            self._set(message, "fields", element)
            if isinstance(element, ros.MessageField):
                self.uses.append(Use(element, field, message, package, document))
        for constant in section.constants:
            features = {"name": constant.name, "type": constant.type, "value": constant.value}
            made = self._new(ros.Constant, **features)
            self._adopt(made, document, constant.line, constant.column)
            self._document(made, constant.comment)
            self._set(message, "constants", made)
        return message

    def _field(self, field: FieldDefinition) -> ros.Field:
        kind = field.type
        element: ros.Field
        common = {"name": field.name, "arrayKind": kind.array, "arraySize": kind.array_size}
        if kind.is_primitive:
            element = self._new(
                ros.PrimitiveField, **common, type=kind.name, stringBound=kind.string_bound
            )
            if field.default is not None:
                self._set(element, "defaultValue", field.default)
        else:
            element = self._new(ros.MessageField, **common)
        self._document(element, field.comment)
        if self._with_comments and _is_unit(field.units):
            self._set(element, "units", field.units)
        return element

    def _document(self, element: EObject, comment: str) -> None:
        if comment and self._with_comments:
            self._set(element, "documentation", comment)

    def _new(self, kind: type[ElementT], /, **features: Any) -> ElementT:
        element: ElementT = new_object(self._model.metamodels.class_of(kind))
        for name, value in features.items():
            self._set(element, name, value)
        return element

    def _set(self, element: EObject, name: str, value: Any) -> None:
        feature = self._model.metamodels.class_of(element).features[name]
        if feature.kind is not FeatureKind.ATTRIBUTE:
            link(element, feature, value)
            return
        data_type = feature.data_type
        if data_type is not None and data_type.kind is ValueKind.ENUMERATION:
            value = data_type.literals[value]
        set_value(element, feature, value)

    def _adopt(self, element: EObject, document: Document, line: int, column: int) -> Node:
        node = Node(str(element.eClass.name), [], {}, None, (line, column, 0))
        node.obj = element
        self._model.adopt(document, node)
        return node


def _is_unit(text: str) -> bool:
    try:
        return bool(text) and parse_unit(text) is not None
    except UnitError:
        return False
