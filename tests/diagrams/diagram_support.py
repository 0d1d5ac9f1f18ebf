"""Graphs of models, and what must hold of each."""

from pathlib import Path

from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml.views.diagrams.views import graph_of, view_names

MODELS = Path(__file__).resolve().parents[2] / "models"
CAR = MODELS / "catvehicle" / "catvehicle.xmi"


def read(path):
    """Returns what was found about a model file, and the model."""
    return check(read_models([path], notations=NOTATIONS))


def graphs(report, *, library=False):
    """Yields the graph of each view."""
    for view in view_names(report.model, library=library):
        yield graph_of(report.model, view, report.diagnostics)


def look_at(graph):
    """Complains where edges end nowhere, groups are unknown or ids are not distinct."""
    ends = {(node.id, "") for node in graph.nodes}
    ends |= {(node.id, port.id) for node in graph.nodes for port in node.ports}
    for edge in graph.edges:
        assert (edge.source.node, edge.source.port) in ends, edge
        assert (edge.target.node, edge.target.port) in ends, edge
    groups = [frame.id for frame in graph.groups]
    assert {box.group for box in graph.nodes} <= {"", *groups}
    for index, group in enumerate(graph.groups):
        assert group.parent in ("", *groups[:index]), group
    for ids in (groups, [e.id for e in graph.edges], [n.id for n in graph.nodes]):
        assert len(ids) == len(set(ids)), ids
    for node in graph.nodes:
        ports = [port.id for port in node.ports]
        assert len(ports) == len(set(ports)), ports
