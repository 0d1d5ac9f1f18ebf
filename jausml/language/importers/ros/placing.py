"""Documents for imported packages: which of them holds which package."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.xmi.parsing import Node

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.language.importers.ros.importing import ImportResult
    from jausml.language.metamodel.classes import ros
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.semantics.installed import InterfaceType


def placed(result: ImportResult, places: Mapping[Path, Sequence[ros.InterfacePackage]]) -> Model:
    """Returns the model of the documents to be written, in which every type has its id.

    An id is the name of the type; where a document holds several packages, the package stands
    before it.

    Args:
        result: What was imported.
    """
    shipped = [document for document in result.model.documents if document.is_library]
    model = Model(shipped, result.model.metamodels)
    for document in shipped:
        for node in document.root_nodes:
            for element in _elements(result.model, node.obj):
                model.adopt(document, _stand_in(element))
                model.name_by_id(element, result.model.identifier(element) or "")
    for path, packages in places.items():
        document = Document(Path(os.path.realpath(path)), str(path), is_library=False, given=True)
        model.documents.append(document)
        taken: set[str] = set()
        for package in packages:
            node = _stand_in(package)
            document.root_nodes.append(node)
            model.adopt(document, node)
            model.name_by_id(package, f"package.{package.name}")
            prefix = f"{package.name}." if len(packages) > 1 else ""
            for element in _types(package):
                identifier = f"{prefix}{element.name}"
                if identifier in taken:  # a service may have the name of a message
                    identifier = f"{prefix}{element.eContainmentFeature().name}.{element.name}"
                taken.add(identifier)
                model.name_by_id(element, identifier)
    return model


def _types(package: ros.InterfacePackage) -> Iterator[InterfaceType]:
    yield from package.messages
    for service in package.services:
        yield from (service, service.request, service.response)
    for action in package.actions:
        yield from (action, action.goal, action.result, action.feedback)


def _elements(model: Model, root: EObject) -> Iterator[EObject]:
    pending = [root]
    while pending:
        element = pending.pop()
        if model.identifier(element) is not None:
            yield element
        pending += model.owned(element)


def _stand_in(element: EObject) -> Node:
    node = Node(str(element.eClass.name), [], {}, None, (1, 1, 0))
    node.obj = element
    return node
