"""Graphs as Mermaid flow charts, which GitHub and many editors show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.views.diagrams.graph import nested, severity
from jausml.views.diagrams.writers.colours import SIDES, outline

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.views.diagrams.graph import Edge, Graph, Node, Port

_SHAPES = {"bridge": ("[[", "]]"), "node": ("(", ")"), "type": ("(", ")"), "state": ("(", ")")}
_WIDTHS = {"bridge": ",stroke-width:3px", "error": ",stroke-width:4px"}
_DASHED = ("control", "owns")
_MOST_ROWS = 60


def render(graph: Graph) -> str:
    """Returns a graph as a flow chart."""
    return "\n".join(_lines(graph)) + "\n"


def _lines(graph: Graph) -> Iterator[str]:
    names = {each.id: f"n{index}" for index, each in enumerate(graph.nodes)}
    yield f"flowchart {'TB' if graph.downwards else 'LR'}"
    for what, number, depth in nested(graph.nodes, graph.groups):
        indent = "  " * (depth + 1)
        match what:
            case "box":
                yield f"{indent}{_node(graph.nodes[number], names)}"
            case "begin":
                yield f'{indent}subgraph g{number}["{as_data(graph.groups[number].title)}"]'
            case "end":
                yield f"{indent}end"
    for edge in graph.edges:
        yield f"  {_edge(edge, names)}"
    classes: dict[str, list[str]] = {}
    for node in graph.nodes:
        classes.setdefault(_class(node), []).append(names[node.id])
    for name in sorted(classes.keys() & {*SIDES, "error"}):
        yield f"  classDef {name} stroke:{outline(name, name)}{_WIDTHS.get(name, '')}"
        yield f"  class {','.join(classes[name])} {name}"


def _class(node: Node) -> str:
    return "error" if severity(node.findings) == "error" else node.kind


def _node(node: Node, names: dict[str, str]) -> str:
    before, after = _SHAPES.get(node.kind, ("[", "]"))
    lines = [f"<b>{as_data(node.title)}</b>", *([as_data(node.subtitle)] if node.subtitle else [])]
    lines += [_row(each) for each in node.ports[:_MOST_ROWS]]
    if len(node.ports) > _MOST_ROWS:
        lines.append(f"and {len(node.ports) - _MOST_ROWS} more")
    lines += [as_data(f"{each.severity}: {each.message}") for each in node.findings]
    return f'{names[node.id]}{before}"{"<br/>".join(lines)}"{after}'


def _row(port: Port) -> str:
    words = " ".join(each for each in (port.label, port.note, port.mark) if each)
    wrong = severity(port.findings)
    return "\N{NO-BREAK SPACE}" * 2 * port.depth + as_data(f"{wrong}: {words}" if wrong else words)


def _edge(edge: Edge, names: dict[str, str]) -> str:
    arrow = "-.->" if edge.kind in _DASHED else "-->"
    first = () if edge.title in edge.labels else (edge.title,)
    label = "<br/>".join(as_data(each) for each in (*first, *edge.labels) if each)
    middle = f'|"{label}"|' if label else ""
    return f"{names[edge.source.node]} {arrow}{middle} {names[edge.target.node]}"


def as_data(text: str) -> str:
    """Returns a text as data: Mermaid and HTML find no signs of theirs in it."""
    return "".join(_sign(each) for each in " ".join(text.split()))


def _sign(sign: str) -> str:
    if sign.isalnum() or sign in " .,:/_-()+=*?":
        return sign
    if not sign.isprintable():
        return "\N{REPLACEMENT CHARACTER}"
    return f"#{ord(sign)};"
