"""Whatever bridges there are: split, each connection is in one, with all that it shares."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import compositions
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.generation import load_targets, render
from jausml.generation.system import system_of
from jausml.language.semantics.connections.topics import resolve_topic
from jausml.language.text.notation import NOTATIONS
from jausml.language.text.writing.unparsing import to_text
from jausml.language.validation.engine import validate
from jausml.views.analysis.assumptions import Assumptions
from jausml.views.analysis.partition import UnsplittableError, propose
from jausml.views.analysis.splitting import split
from jausml.views.analysis.streams import is_single, is_to_ros, keeps_control

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "12"))


@settings(max_examples=EXAMPLES // 2, suppress_health_check=list(HealthCheck), deadline=None)
@given(data=st.data())
def test_parts_share_nothing_and_lose_nothing(data):
    text = compositions.composition(lambda things: data.draw(st.sampled_from(things)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "model.ros2jaus")
        path.write_text(text, encoding="utf-8")
        report = validate([path], notations=NOTATIONS)
        if report.has_errors:
            return
        system = system_of(report.model)
        before = {each: each.name for owner in system.bridges for each in owner.bridgeConnections}
        topics = full_topics(system)
        number = data.draw(st.sampled_from([None, 2, 3, 5]))
        try:
            proposal = propose(system, Assumptions(), number)
        except UnsplittableError:
            return
        bridges = split(proposal, system)
        assert list(dict.fromkeys(bridges)) == bridges
        assert set(bridges) == set(system.bridges)
        assert number in (None, len(bridges))
        after = [each for owner in bridges for each in owner.bridgeConnections]
        assert len(after) == len(before)
        assert set(after) == set(before)
        assert full_topics(system) == topics
        shared_things_are_in_one_place(proposal, bridges)
        written = Path(folder, "split.ros2jaus")
        written.write_text(to_text(report.model.documents[0].roots, report.model, written), "utf-8")
        again = validate([written], notations=NOTATIONS)
        assert kinds(again) <= kinds(report)
        targets = [each for each in load_targets().values() if each.name == "bridge"]
        assert render(again.model, targets)


def kinds(report):
    return {(each.rule, each.severity.name) for each in report.diagnostics}


def full_topics(system):
    return {
        (each.name, resolve_topic(topic.name, owner.namespace or "", owner.name))
        for owner in system.bridges
        for each in owner.bridgeConnections
        for topic in each.topics
    }


def shared_things_are_in_one_place(proposal, bridges):
    places = {}
    for part, owner in zip(proposal.parts, bridges, strict=True):
        assert [c for group in part.groups for c in group.connections]
        for each in owner.bridgeConnections:
            for thing in shared_by(owner, each):
                assert places.setdefault((part.origin, thing), owner) is owner


def shared_by(owner, connection):
    for topic in connection.topics:
        yield resolve_topic(topic.name, owner.namespace or "", owner.name)
    if keeps_control(connection):
        yield from connection.peers
    if is_to_ros(connection) and not is_single(connection):
        yield from ((peer, connection.map.message) for peer in connection.peers)
    if not is_to_ros(connection) and not is_single(connection):
        yield "report", connection.map.message
