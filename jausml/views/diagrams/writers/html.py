"""A page that stands alone, with picture, tables, filter and details; it asks no host."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Any

from jausml.views.diagrams.bundling import bundled, is_crowded
from jausml.views.diagrams.graph import Edge, End, Finding, Graph, Node, Port
from jausml.views.diagrams.ordering import ordered
from jausml.views.diagrams.writers import shapes, svg
from jausml.views.diagrams.writers.shapes import cut
from jausml.views.diagrams.writers.svg import Keys
from jausml.views.pages import hashed

_PAGE = Path(__file__).parent / "page"


def render(graph: Graph, theme: str = "auto") -> str:
    """Returns a graph as a page."""
    shown = ordered(bundled(graph))
    script = (_PAGE / "diagram.js").read_text(encoding="utf-8")
    style = shapes.variables() + (_PAGE / "diagram.css").read_text(encoding="utf-8")
    keys = svg.Keys()
    picture = svg.picture(shown, theme, is_bundled=is_crowded(graph), keys=keys)
    # Of a text within a script the sign that could end it is written as JSON writes any sign.
    known = json.dumps(dict(_known(shown, keys)), ensure_ascii=True).replace("<", "\\u003c")
    policy = "; ".join(
        (
            "default-src 'none'",
            f"script-src {hashed(script)}",
            f"style-src {hashed(style)} {hashed(shapes.style(theme, compares=shown.compares))}",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(cut(shown.title, 90))}</title>
<style>{style}</style>
</head>
<body>
<header>
<input id="filter" type="search" placeholder="filter (/)" aria-label="filter by name">
<button id="closer" type="button" aria-label="closer">+</button>
<button id="further" type="button" aria-label="further away">&#8722;</button>
<button id="fit" type="button">fit (0)</button>
<button id="tables" type="button" aria-pressed="false">tables (t)</button>
<details id="help"><summary>keys (?)</summary>
<dl>
<dt>/</dt><dd>filter; Enter chooses the first match</dd>
<dt>n, p</dt><dd>the next and the previous box, row or edge</dd>
<dt>o, i</dt><dd>out and in: from a box to its edges, from an edge to its ends</dd>
<dt>Esc</dt><dd>nothing chosen</dd>
<dt>t</dt><dd>tables in the place of the picture</dd>
<dt>+ - 0, arrows</dt><dd>closer, further away, all of it, aside</dd>
</dl>
</details>
</header>
<main>
{picture}<section id="list" aria-label="tables" hidden>
{_tables(shown, keys)}
</section>
<aside id="details" aria-live="polite" hidden></aside>
</main>
<script type="application/json" id="known">{known}</script>
<script>{script}</script>
</body>
</html>
"""


def _known(graph: Graph, keys: svg.Keys) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yields the details of boxes, rows and edges by the keys that the picture has."""
    for node in graph.nodes:
        own = keys.node(node.id)
        yield own, _entry(node.title, _text(node), node, [])
        for port in node.ports:
            entry = _entry(port.label, f"{port.label} {port.note}", port, [own])
            yield keys.port(node.id, port.id), entry
    titles = {graph_node.id: graph_node.title for graph_node in graph.nodes}
    labels = {(node.id, port.id): port.label for node in graph.nodes for port in node.ports}
    for edge in graph.edges:
        source, target = titles[edge.source.node], titles[edge.target.node]
        title = f"{source} \N{RIGHTWARDS ARROW} {target}"
        keys_by_direction = {
            name: [key for key in (keys.port(end.node, end.port), keys.node(end.node)) if key]
            for name, end in (("from", edge.source), ("to", edge.target))
        }
        rows = [labels.get((end.node, end.port), "") for end in (edge.source, edge.target)]
        text = " ".join([edge.title, source, target, *rows])
        entry = _entry(
            title, text, edge, [key for ends in keys_by_direction.values() for key in ends]
        )
        yield keys.edge(edge.id), entry | keys_by_direction


def _text(node: Node) -> str:
    return " ".join([node.title, node.subtitle, *(port.label for port in node.ports)])


def _entry(title: str, text: str, part: Node | Port | Edge, ends: list[str]) -> dict[str, Any]:
    first = []
    if isinstance(part, Edge):
        first = [["flows", part.title], ["how", ", ".join(part.labels)]]
    return {
        "title": title,
        "text": text,
        "ends": ends,
        "findings": [[finding.severity, finding.message] for finding in part.findings],
        "details": [detail for detail in [*first, *map(list, part.details)] if detail[1]],
    }


_LONGEST = 400
_EDGES = ("from", "row", "to", "row", "flows", "how", "findings")
_BOXES = ("box", "kind", "row", "type", "mark", "findings")


def _tables(graph: Graph, keys: Keys) -> str:
    """Returns two tables of a page: edges, and boxes."""
    return "\n".join(
        (
            *_table("edges", "What flows", _EDGES, _edges(graph, keys)),
            *_table("boxes", "What there is", _BOXES, _boxes(graph, keys)),
        )
    )


def _table(
    name: str, caption: str, heads: Sequence[str], rows: Iterable[tuple[str, Sequence[str]]]
) -> Iterator[str]:
    yield f'<table id="{name}"><caption>{caption}</caption>'
    cells = "".join(f'<th scope="col"><button type="button">{head}</button></th>' for head in heads)
    yield f"<thead><tr>{cells}</tr></thead><tbody>"
    for key, texts in rows:
        first, *others = (escape(cut(text, _LONGEST)) for text in texts)
        cells = "".join(f"<td>{other}</td>" for other in others)
        yield f'<tr data-key="{key}"><td><button type="button">{first}</button></td>{cells}</tr>'
    yield "</tbody></table>"


def _edges(graph: Graph, keys: Keys) -> Iterator[tuple[str, Sequence[str]]]:
    titles = {node.id: node.title for node in graph.nodes}
    labels = {(node.id, port.id): port.label for node in graph.nodes for port in node.ports}

    def end(at: End) -> tuple[str, str]:
        return titles[at.node], labels.get((at.node, at.port), "")

    for edge in graph.edges:
        texts = (*end(edge.source), *end(edge.target), edge.title, _how(edge))
        yield keys.edge(edge.id), (*texts, _findings(edge.findings))


def _how(edge: Edge) -> str:
    labels = [label for label in edge.labels if label != edge.title]
    if edge.count > 1:
        labels.append(f"{edge.count} connections")
    return ", ".join(labels) or edge.kind


def _boxes(graph: Graph, keys: Keys) -> Iterator[tuple[str, Sequence[str]]]:
    for node in graph.nodes:
        own = (node.title, node.kind)
        yield keys.node(node.id), (*own, "", node.subtitle, "", _findings(node.findings))
        for port in node.ports:
            row = (port.label, port.note, port.mark, _findings(port.findings))
            yield keys.port(node.id, port.id), (*own, *row)


def _findings(findings: tuple[Finding, ...]) -> str:
    return "; ".join(f"{finding.severity}: {finding.message}" for finding in findings)
