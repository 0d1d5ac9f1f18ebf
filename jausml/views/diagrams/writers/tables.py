"""Graphs as tables: the same as a picture, for those who read, sort, search or listen."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from jausml.views.diagrams.writers.text_width import cut

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.views.diagrams.graph import Edge, End, Finding, Graph
    from jausml.views.diagrams.writers.svg import Keys

_LONGEST = 400
_EDGES = ("from", "row", "to", "row", "flows", "how", "findings")
_BOXES = ("box", "kind", "row", "type", "mark", "findings")


def render(graph: Graph, keys: Keys) -> str:
    """Returns two tables of a page: what flows, and what there is."""
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
    cells = "".join(f'<th scope="col"><button type="button">{each}</button></th>' for each in heads)
    yield f"<thead><tr>{cells}</tr></thead><tbody>"
    for key, texts in rows:
        first, *others = (escape(cut(each, _LONGEST)) for each in texts)
        cells = "".join(f"<td>{each}</td>" for each in others)
        yield f'<tr data-key="{key}"><td><button type="button">{first}</button></td>{cells}</tr>'
    yield "</tbody></table>"


def _edges(graph: Graph, keys: Keys) -> Iterator[tuple[str, Sequence[str]]]:
    titles = {each.id: each.title for each in graph.nodes}
    labels = {(node.id, port.id): port.label for node in graph.nodes for port in node.ports}

    def end(at: End) -> tuple[str, str]:
        return titles[at.node], labels.get((at.node, at.port), "")

    for edge in graph.edges:
        texts = (*end(edge.source), *end(edge.target), edge.title, _how(edge))
        yield keys.edge(edge.id), (*texts, _findings(edge.findings))


def _how(edge: Edge) -> str:
    labels = [each for each in edge.labels if each != edge.title]
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
    return "; ".join(f"{each.severity}: {each.message}" for each in findings)
