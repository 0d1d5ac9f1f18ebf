"""Graphs as text for whoever lays them out: Mermaid flow charts, and the language of Graphviz."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from jausml.views.diagrams.graph import Edge, End, Finding, Graph, Node, Port, severity
from jausml.views.diagrams.writers.shapes import SIDES, outline

_SHAPES = {"bridge": ("[[", "]]"), "node": ("(", ")"), "type": ("(", ")"), "state": ("(", ")")}
_WIDTHS = {"bridge": ",stroke-width:3px", "error": ",stroke-width:4px"}
_DASHED = ("control", "owns")
_MOST_ROWS = 60


def render_mermaid(graph: Graph) -> str:
    """Returns a graph as a flow chart."""
    return "\n".join(_mermaid_lines(graph)) + "\n"


def _mermaid_lines(graph: Graph) -> Iterator[str]:
    names = {graph_node.id: f"n{index}" for index, graph_node in enumerate(graph.nodes)}
    yield f"flowchart {'TB' if graph.downwards else 'LR'}"
    for what, number, depth in graph.nesting:
        indent = "  " * (depth + 1)
        match what:
            case "box":
                yield f"{indent}{_mermaid_node(graph.nodes[number], names)}"
            case "begin":
                yield f'{indent}subgraph g{number}["{as_data(graph.groups[number].title)}"]'
            case "end":
                yield f"{indent}end"
    for edge in graph.edges:
        yield f"  {_mermaid_edge(edge, names)}"
    for number, finding in enumerate(graph.findings):
        yield f'  w{number}["{as_data(_sentence(finding))}"]'
    classes: dict[str, list[str]] = {}
    for node in graph.nodes:
        classes.setdefault(_class(node), []).append(names[node.id])
    for name in sorted(classes.keys() & {*SIDES, "error"}):
        yield f"  classDef {name} stroke:{outline(name, name)}{_WIDTHS.get(name, '')}"
        yield f"  class {','.join(classes[name])} {name}"


def _class(node: Node) -> str:
    return "error" if severity(node.findings) == "error" else node.kind


def _mermaid_node(node: Node, names: dict[str, str]) -> str:
    before, after = _SHAPES.get(node.kind, ("[", "]"))
    lines = [f"<b>{as_data(node.title)}</b>", *([as_data(node.subtitle)] if node.subtitle else [])]
    for port in node.ports[:_MOST_ROWS]:
        lines.append("\N{NO-BREAK SPACE}" * 2 * port.depth + as_data(_words(port, " ")))
    if len(node.ports) > _MOST_ROWS:
        lines.append(f"and {len(node.ports) - _MOST_ROWS} more")
    lines += [as_data(_sentence(finding)) for finding in node.findings]
    return f'{names[node.id]}{before}"{"<br/>".join(lines)}"{after}'


def _words(port: Port, gap: str) -> str:
    """Returns the words of a row, first its severity."""
    words = gap.join(part for part in (port.label, port.note, port.mark) if part)
    wrong = severity(port.findings)
    return f"{wrong}: {words}" if wrong else words


def _sentence(finding: Finding) -> str:
    return f"{finding.severity}: {finding.message}"


def _labels(edge: Edge) -> list[str]:
    """Returns the lines of a label, first its severity."""
    first = () if edge.title in edge.labels else (edge.title,)
    return [label for label in (severity(edge.findings), *first, *edge.labels) if label]


def _mermaid_edge(edge: Edge, names: dict[str, str]) -> str:
    arrow = "-.->" if edge.kind in _DASHED else "-->"
    label = "<br/>".join(map(as_data, _labels(edge)))
    middle = f'|"{label}"|' if label else ""
    return f"{names[edge.source.node]} {arrow}{middle} {names[edge.target.node]}"


def as_data(text: str) -> str:
    """Returns a text as data: Mermaid and HTML find no signs of theirs in it."""
    return "".join(_sign(character) for character in " ".join(text.split()))


def _sign(sign: str) -> str:
    if sign.isalnum() or sign in " .,:/_-()+=*?":
        return sign
    if not sign.isprintable():
        return "\N{REPLACEMENT CHARACTER}"
    return f"#{ord(sign)};"


def render_dot(graph: Graph) -> str:
    """Returns a graph as a file of Graphviz."""
    return "\n".join(_dot_lines(graph)) + "\n"


def _dot_lines(graph: Graph) -> Iterator[str]:
    names = {node.id: f"n{index}" for index, node in enumerate(graph.nodes)}
    ports = {
        (node.id, port.id): f"{names[node.id]}:p{index}"
        for node in graph.nodes
        for index, port in enumerate(node.ports)
    }
    yield "digraph {"
    yield f'  graph [rankdir={"TB" if graph.downwards else "LR"}, fontname="sans-serif"]'
    yield '  node [shape=plain, fontname="sans-serif", fontsize=11]'
    yield '  edge [fontname="sans-serif", fontsize=10]'
    for what, number, depth in graph.nesting:
        indent = "  " * (depth + 1)
        match what:
            case "box":
                yield f"{indent}{_dot_node(graph.nodes[number], names)}"
            case "begin":
                yield f"{indent}subgraph cluster_{number} {{"
                yield f"{indent}  label=<{_text(graph.groups[number].title)}>; style=rounded"
            case "end":
                yield f"{indent}}}"
    for edge in graph.edges:
        yield f"  {_dot_edge(edge, names, ports)}"
    for number, finding in enumerate(graph.findings):
        yield f"  w{number} [label=<{_text(_sentence(finding))}>]"
    yield "}"


def _dot_node(node: Node, names: dict[str, str]) -> str:
    colour = outline(node.kind, severity(node.findings))
    rows = [f"<tr><td><b>{_text(node.title)}</b></td></tr>"]
    if node.subtitle:
        rows.append(f"<tr><td>{_text(node.subtitle)}</td></tr>")
    rows += [_dot_row(index, port) for index, port in enumerate(node.ports)]
    rows += [
        f'<tr><td align="left">{_text(_sentence(finding))}</td></tr>' for finding in node.findings
    ]
    table = f'<table border="2" cellborder="0" cellspacing="0" color="{colour}">'
    return f"{names[node.id]} [label=<{table}{''.join(rows)}</table>>]"


def _dot_row(index: int, port: Port) -> str:
    text = "&#160;" * 3 * port.depth + _text(_words(port, "  "))
    return f'<tr><td port="p{index}" align="left">{text}</td></tr>'


def _dot_edge(edge: Edge, names: dict[str, str], ports: dict[tuple[str, str], str]) -> str:
    def end(at: End) -> str:
        return ports.get((at.node, at.port), names[at.node])

    label = "<br/>".join(map(_text, _labels(edge)))
    known = [f"label=<{label}>"] if label else []
    known += ["style=dashed"] if edge.kind in _DASHED else []
    options = f" [{', '.join(known)}]" if known else ""
    return f"{end(edge.source)} -> {end(edge.target)}{options}"


def _text(text: str) -> str:
    """Returns a text as data, without signs of Graphviz."""
    flat = "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}"
        for character in " ".join(text.split())
    )
    return escape(flat) or " "
