"""Makes ROS elements of definitions; they know where in the files they come from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.interfaces.parsing import PARTS
from jausml.languages.units import UnitError, parse_unit
from jausml.metamodel import FeatureKind, ValueKind
from jausml.metamodel.filling import link, new_object, set_value
from jausml.model.xmi.parsing import Node

if TYPE_CHECKING:
    from jausml.interfaces import Definition, FieldDefinition, Section
    from jausml.model.documents import Document
    from jausml.model.model import Model

_FEATURES = {"msg": "messages", "srv": "services", "action": "actions"}
_CLASSES = {"srv": "ServiceType", "action": "ActionType"}


@dataclass(frozen=True, slots=True)
class Use:
    """A field whose type is a message type that is still to be found.

    Attributes:
        element: The `ros.MessageField`.
        field: What the definition says.
        owner: The message type that has the field.
        package: Name of the package of the owner.
        document: The file.
    """

    element: Any
    field: FieldDefinition
    owner: Any
    package: str
    document: Document


class Builder:
    """Makes the elements of packages.

    Args:
        model: The model that they belong to.
        comments: Whether comments become documentation, and units in them units.

    Attributes:
        uses: The fields whose types are message types.
    """

    def __init__(self, model: Model, *, comments: bool) -> None:
        self._model = model
        self._with_comments = comments
        self.uses: list[Use] = []

    def package(self, name: str, document: Document | None) -> Any:
        """Makes a package.

        Args:
            name: Its name.
            document: The file that stands for it in messages.
        """
        package = self._new("InterfacePackage", name=name)
        if document is not None:
            node = self._adopt(package, document, 1, 1)
            document.root_nodes.append(node)
        return package

    def interface(
        self, package: Any, name: str, kind: str, definition: Definition, document: Document
    ) -> Any:
        """Makes a message, service or action and adds it to its package.

        Args:
            package: The package.
            name: Name of the interface.
            kind: `msg`, `srv` or `action`.
            definition: What its file says.
            document: The file.
        """
        place = (package.name, document)
        if kind == "msg":
            element = self._message(name, definition.sections[0], *place)
        else:
            element = self._new(_CLASSES[kind], name=name)
            self._adopt(element, document, 1, 1)
            head = definition.sections[0]
            self._document(element, head.comment)
            head.comment = ""
            for part, section in zip(PARTS[kind], definition.sections, strict=True):
                message = self._message(f"{name}_{part.capitalize()}", section, *place)
                self._set(element, part, message)
        self._set(package, _FEATURES[kind], element)
        return element

    def set(self, element: Any, name: str, value: Any) -> None:
        """Sets a feature, or adds to one with many values.

        Args:
            element: The element.
            name: The feature.
            value: One value; an enumeration literal by its name.
        """
        self._set(element, name, value)

    def _message(self, name: str, section: Section, package: str, document: Document) -> Any:
        message = self._new("MessageType", name=name)
        self._adopt(message, document, section.line, 1)
        self._document(message, section.comment)
        for field in section.fields:
            element = self._field(field)
            self._adopt(element, document, field.line, field.column)
            self._set(message, "fields", element)
            if not field.type.is_primitive:
                self.uses.append(Use(element, field, message, package, document))
        for constant in section.constants:
            features = {"name": constant.name, "type": constant.type, "value": constant.value}
            element = self._new("Constant", **features)
            self._adopt(element, document, constant.line, constant.column)
            self._document(element, constant.comment)
            self._set(message, "constants", element)
        return message

    def _field(self, field: FieldDefinition) -> Any:
        kind = field.type
        common = {"name": field.name, "arrayKind": kind.array, "arraySize": kind.array_size}
        if kind.is_primitive:
            element = self._new(
                "PrimitiveField", **common, type=kind.name, stringBound=kind.string_bound
            )
            if field.default is not None:
                self._set(element, "defaultValue", field.default)
        else:
            element = self._new("MessageField", **common)
        self._document(element, field.comment)
        if self._with_comments and _is_unit(field.units):
            self._set(element, "units", field.units)
        return element

    def _document(self, element: Any, comment: str) -> None:
        if comment and self._with_comments:
            self._set(element, "documentation", comment)

    def _new(self, class_name: str, **features: Any) -> Any:
        element = new_object(self._model.metamodels.classes[f"ros.{class_name}"])
        for name, value in features.items():
            self._set(element, name, value)
        return element

    def _set(self, element: Any, name: str, value: Any) -> None:
        feature = self._model.metamodels.class_of(element).features[name]
        if feature.kind is not FeatureKind.ATTRIBUTE:
            link(element, feature, value)
            return
        data_type = feature.data_type
        if data_type is not None and data_type.kind is ValueKind.ENUMERATION:
            value = data_type.literals[value]
        set_value(element, feature, value)

    def _adopt(self, element: Any, document: Document, line: int, column: int) -> Node:
        node = Node(str(element.eClass.name), [], {}, None, (line, column, 0))
        node.obj = element
        self._model.adopt(document, node)
        return node


def _is_unit(text: str) -> bool:
    try:
        return bool(text) and parse_unit(text) is not None
    except UnitError:
        return False
