"""Models of elements that were made here and stand in no file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from jausml.language.model import Document, Model
from jausml.language.model.xmi.parsing import Node

if TYPE_CHECKING:
    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes.ecore import EObject

_PATH = "trial.xmi"


def made_model(metamodels: Metamodels, root: EObject, *inner: EObject) -> Model:
    """Returns a model of one document that nobody wrote."""
    document = Document(Path(_PATH), _PATH, is_library=False, given=True)
    model = Model([document], metamodels)
    top = _node(root, None)
    document.root_nodes.append(top)
    model.adopt(document, top)
    for each in inner:
        node = _node(each, top)
        top.children.append(node)
        model.adopt(document, node)
    return model


def _node(element: EObject, parent: Node | None) -> Node:
    node = Node("", [], {}, parent, (1, 1, 0))
    node.obj = element
    return node
