"""Graphs in the language of Graphviz, for whoever lays them out by himself."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from jausml.views.diagrams.graph import nested, severity
from jausml.views.diagrams.writers.colours import outline

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.views.diagrams.graph import Edge, End, Graph, Node, Port

_DASHED = ("control", "owns")


def render(graph: Graph) -> str:
    """Returns a graph as a file of Graphviz."""
    return "\n".join(_lines(graph)) + "\n"


def _lines(graph: Graph) -> Iterator[str]:
    names = {each.id: f"n{index}" for index, each in enumerate(graph.nodes)}
    ports = {
        (node.id, port.id): f"{names[node.id]}:p{index}"
        for node in graph.nodes
        for index, port in enumerate(node.ports)
    }
    yield "digraph {"
    yield f'  graph [rankdir={"TB" if graph.downwards else "LR"}, fontname="sans-serif"]'
    yield '  node [shape=plain, fontname="sans-serif", fontsize=11]'
    yield '  edge [fontname="sans-serif", fontsize=10]'
    for what, number, depth in nested(graph.nodes, graph.groups):
        indent = "  " * (depth + 1)
        match what:
            case "box":
                yield f"{indent}{_node(graph.nodes[number], names)}"
            case "begin":
                yield f"{indent}subgraph cluster_{number} {{"
                yield f"{indent}  label=<{_text(graph.groups[number].title)}>; style=rounded"
            case "end":
                yield f"{indent}}}"
    for edge in graph.edges:
        yield f"  {_edge(edge, names, ports)}"
    yield "}"


def _node(node: Node, names: dict[str, str]) -> str:
    colour = outline(node.kind, severity(node.findings))
    rows = [f"<tr><td><b>{_text(node.title)}</b></td></tr>"]
    if node.subtitle:
        rows.append(f"<tr><td>{_text(node.subtitle)}</td></tr>")
    rows += [_row(index, each) for index, each in enumerate(node.ports)]
    rows += [
        f'<tr><td align="left">{_text(f"{each.severity}: {each.message}")}</td></tr>'
        for each in node.findings
    ]
    table = f'<table border="2" cellborder="0" cellspacing="0" color="{colour}">'
    return f"{names[node.id]} [label=<{table}{''.join(rows)}</table>>]"


def _row(index: int, port: Port) -> str:
    words = "  ".join(each for each in (port.label, port.note, port.mark) if each)
    wrong = severity(port.findings)
    text = "&#160;" * 3 * port.depth + _text(f"{wrong}: {words}" if wrong else words)
    return f'<tr><td port="p{index}" align="left">{text}</td></tr>'


def _edge(edge: Edge, names: dict[str, str], ports: dict[tuple[str, str], str]) -> str:
    def end(at: End) -> str:
        return ports.get((at.node, at.port), names[at.node])

    first = () if edge.title in edge.labels else (edge.title,)
    label = "<br/>".join(_text(each) for each in (*first, *edge.labels) if each)
    known = [f"label=<{label}>"] if label else []
    known += ["style=dashed"] if edge.kind in _DASHED else []
    options = f" [{', '.join(known)}]" if known else ""
    return f"{end(edge.source)} -> {end(edge.target)}{options}"


def _text(text: str) -> str:
    """Returns a text as data: Graphviz finds no signs of its own in it."""
    flat = "".join(
        each if each.isprintable() else "\N{REPLACEMENT CHARACTER}"
        for each in " ".join(text.split())
    )
    return escape(flat) or " "
