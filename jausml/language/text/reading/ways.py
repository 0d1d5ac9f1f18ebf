"""Direction and exchange of connections whose text leaves them open."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.language.metamodel.filling import set_value
from jausml.language.model.notation import Fault
from jausml.language.semantics.connections.ways import CONNECTION, FEATURES, settle
from jausml.language.semantics.memory import remembering

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Any

    from jausml.language.metamodel import ClassTable, DataTypeTable
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.semantics.connections.ways import Settled

_SERVICES, _PEERS = ("provides", "uses"), ("map", "peers", "query")


def settle_connections(classes: Iterable[tuple[Node, ClassTable]]) -> list[Fault]:
    """Gives connections what follows from all else; returns what several ways would be."""
    wanted = [
        (node, table)
        for node, table in classes
        if table.qualified_name == CONNECTION and node.obj is not None
    ]
    # What services have does not change while ways are settled.
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
    settled = settle(connection, **stated, is_known=is_known)
    for name in unstated:
        feature = table.features[name]
        literals = cast("DataTypeTable", feature.data_type).literals
        set_value(connection, feature, literals[getattr(settled, name)])
    if len(settled.ways) > 1:
        yield _ambiguous(node, settled)


def _is_read(node: Node, features: Iterable[str]) -> bool:
    """Tells whether all references that a text has of some features were resolved."""
    for name in features:
        written = sum(child.tag == name for child in node.children)
        value = getattr(node.obj, name)
        read = len(value) if hasattr(value, "__len__") else int(value is not None)
        if read < written:
            return False
    return True


def _ambiguous(node: Node, settled: Settled) -> Fault:
    connection: Any = node.obj
    message = f"'{connection.name}' may carry {connection.map.message.name} in several ways"
    telling = [name for name in FEATURES if len({getattr(each, name) for each in settled.ways}) > 1]
    ways = [
        f"{'  '.join(f'{name}: {getattr(each, name)}' for name in telling)} ({each.meaning})"
        for each in settled.ways
    ]
    hint = f"write {', or '.join(ways)}"
    return Fault("JML715", message, hint, node.line, node.column, node)
