"""Graphs as Mermaid flow charts, which GitHub and many editors show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.diagrams.graph import severity

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.diagrams.graph import Edge, Graph, Group, Node, Port

_SHAPES = {"bridge": ("[[", "]]"), "node": ("(", ")"), "type": ("(", ")"), "state": ("(", ")")}
_CLASSES = {
    "component": "stroke:#0072B2",
    "message": "stroke:#0072B2",
    "bridge": "stroke:#A8447F,stroke-width:3px",
    "node": "stroke:#00795A",
    "type": "stroke:#00795A",
    "error": "stroke:#B34700,stroke-width:4px",
}
_DASHED = ("control", "owns")
_MOST_ROWS = 60


def render(graph: Graph) -> str:
    """Returns a graph as a flow chart.

    Args:
        graph: The graph.
    """
    return "\n".join(_lines(graph)) + "\n"


def _lines(graph: Graph) -> Iterator[str]:
    names = {each.id: f"n{index}" for index, each in enumerate(graph.nodes)}
    yield f"flowchart {'TB' if graph.downwards else 'LR'}"
    for node in graph.nodes:
        if not node.group:
            yield f"  {_node(node, names)}"
    for group in graph.groups:
        if not group.parent:
            yield from _group(graph, group, names, "  ")
    for edge in graph.edges:
        yield f"  {_edge(edge, names)}"
    used = {_class(each) for each in graph.nodes}
    for name, style in _CLASSES.items():
        if name in used:
            members = ",".join(names[each.id] for each in graph.nodes if _class(each) == name)
            yield f"  classDef {name} {style}"
            yield f"  class {members} {name}"


def _class(node: Node) -> str:
    return "error" if severity(node.findings) == "error" else node.kind


def _group(graph: Graph, group: Group, names: dict[str, str], indent: str) -> Iterator[str]:
    number = graph.groups.index(group)
    yield f'{indent}subgraph g{number}["{_text(group.title)}"]'
    for node in graph.nodes:
        if node.group == group.id:
            yield f"{indent}  {_node(node, names)}"
    for inner in graph.groups:
        if inner.parent == group.id:
            yield from _group(graph, inner, names, f"{indent}  ")
    yield f"{indent}end"


def _node(node: Node, names: dict[str, str]) -> str:
    before, after = _SHAPES.get(node.kind, ("[", "]"))
    lines = [f"<b>{_text(node.title)}</b>", *([_text(node.subtitle)] if node.subtitle else [])]
    lines += [_row(each) for each in node.ports[:_MOST_ROWS]]
    if len(node.ports) > _MOST_ROWS:
        lines.append(f"and {len(node.ports) - _MOST_ROWS} more")
    lines += [_text(f"{each.severity}: {each.message}") for each in node.findings]
    return f'{names[node.id]}{before}"{"<br/>".join(lines)}"{after}'


def _row(port: Port) -> str:
    words = " ".join(each for each in (port.label, port.note, port.mark) if each)
    wrong = severity(port.findings)
    return "\N{NO-BREAK SPACE}" * 2 * port.depth + _text(f"{wrong}: {words}" if wrong else words)


def _edge(edge: Edge, names: dict[str, str]) -> str:
    arrow = "-.->" if edge.kind in _DASHED else "-->"
    first = () if edge.title in edge.labels else (edge.title,)
    label = "<br/>".join(_text(each) for each in (*first, *edge.labels) if each)
    middle = f'|"{label}"|' if label else ""
    return f"{names[edge.source.node]} {arrow}{middle} {names[edge.target.node]}"


def _text(text: str) -> str:
    """Returns a text as data: Mermaid and HTML find no signs of theirs in it."""
    return "".join(_sign(each) for each in " ".join(text.split()))


def _sign(sign: str) -> str:
    if sign.isalnum() or sign in " .,:/_-()+=*?":
        return sign
    if not sign.isprintable():
        return "\N{REPLACEMENT CHARACTER}"
    return f"#{ord(sign)};"
