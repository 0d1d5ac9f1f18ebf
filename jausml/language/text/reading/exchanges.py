"""Direction and exchange of connections whose text leaves them open."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.language.metamodel.filling import set_value
from jausml.language.model.notation import Fault
from jausml.language.semantics.connections.exchanges import CONNECTION, FEATURES, infer
from jausml.language.semantics.memory import remembering

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Any

    from jausml.language.metamodel import ClassTable, DataTypeTable
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.semantics.connections.exchanges import Inferred

_SERVICES, _PEERS = ("provides", "uses"), ("map", "peers", "query")


def infer_exchanges(classes: Iterable[tuple[Node, ClassTable]]) -> list[Fault]:
    """Gives connections what follows from all else; returns what would have several options."""
    wanted = [
        (node, table)
        for node, table in classes
        if table.qualified_name == CONNECTION and node.obj is not None
    ]
    # What services have does not change while exchanges are inferred.
    with remembering():
        return [fault for node, table in wanted for fault in _settle(node, table)]


def _settle(node: Node, table: ClassTable) -> Iterator[Fault]:
    connection: Any = node.obj
    written = {child.tag for child in node.children}
    unstated = [name for name in FEATURES if name not in written]
    if not unstated or connection.map is None:
        return
    stated = {
        name: getattr(getattr(connection, name), "name", None)
        for name in FEATURES
        if name in written
    }
    is_known = _is_read(node, _PEERS) and (node.parent is None or _is_read(node.parent, _SERVICES))
    inferred = infer(connection, **stated, is_known=is_known)
    for name in unstated:
        feature = table.features[name]
        literals = cast("DataTypeTable", feature.data_type).literals
        set_value(connection, feature, literals[getattr(inferred, name)])
    if len(inferred.options) > 1:
        yield _ambiguous(node, inferred)


def _is_read(node: Node, features: Iterable[str]) -> bool:
    """Tells whether all references that a text has of some features were resolved."""
    for name in features:
        written = sum(child.tag == name for child in node.children)
        value = getattr(node.obj, name)
        read = len(value) if hasattr(value, "__len__") else int(value is not None)
        if read < written:
            return False
    return True


def _ambiguous(node: Node, inferred: Inferred) -> Fault:
    connection: Any = node.obj
    message = f"'{connection.name}' may carry {connection.map.message.name} in several ways"
    telling = [
        name for name in FEATURES if len({getattr(each, name) for each in inferred.options}) > 1
    ]
    ways = [
        f"{'  '.join(f'{name}: {getattr(each, name)}' for name in telling)} ({each.meaning})"
        for each in inferred.options
    ]
    hint = f"write {', or '.join(ways)}"
    return Fault("JML715", message, hint, node.line, node.column, node)
