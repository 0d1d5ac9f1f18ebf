"""Services of the shipped library, which imported ones may inherit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.model.reading.reader import read_models
from jausml.language.model.uris import library_root

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def library_model() -> Model:
    """Reads the JAUS service sets of the library, as documents that nobody named."""
    folder = library_root() / "jaus"
    model = read_models(sorted(folder.glob("*.xmi")), project_root=folder).model
    for document in model.documents:
        document.given = False
    return model


def services_by_urn(model: Model) -> dict[str, dict[str, jaus.Service]]:
    """Returns the services of a model by URN and version."""
    found: dict[str, dict[str, jaus.Service]] = {}
    for service in model.instances(jaus.Service):
        found.setdefault(service.urn, {})[service.version] = service
    return found


def join_library(model: Model, library: Model) -> None:
    """Makes the documents of the library documents of a model, which may then refer to them."""
    for document in library.documents:
        model.documents.append(document)
        pending = list(document.root_nodes)
        while pending:
            node = pending.pop()
            pending += node.children
            if node.obj is not None:
                model.adopt(document, node)
                identifier = library.identifier(node.obj)
                if identifier is not None:
                    model.name_by_id(node.obj, identifier)
