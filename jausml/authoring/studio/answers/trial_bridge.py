"""A bridge for one translation: the code that `jausml generate` makes, for values to be tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.model.made import made_model
from jausml.language.semantics.ways import TO_JAUS, TO_ROS
from jausml.live.workers.code import bridge_code
from jausml.live.workers.making import Maker

if TYPE_CHECKING:
    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes import bridge
    from jausml.language.model import Model
    from jausml.live.workers.code import BridgeCode

BRIDGE_NAME, CONNECTION_NAME = "trial", "tried"
_SYSTEM = "trial_system"


def trial_bridge(metamodels: Metamodels, used: bridge.AttributeMap, *, to_ros: bool) -> BridgeCode:
    """Returns the generated code of one direction of a map, whatever else its model holds."""
    return bridge_code(_model(metamodels, used, to_ros=to_ros))


def _model(metamodels: Metamodels, used: bridge.AttributeMap, *, to_ros: bool) -> Model:
    """Makes a system with a bridge that has one connection, by the map."""
    make = Maker(metamodels)
    connection = make(
        "bridge.Connection", name=CONNECTION_NAME, direction=TO_ROS if to_ros else TO_JAUS
    )
    make.own(connection, "topics", make("bridge.Topic", name=CONNECTION_NAME))
    if to_ros:
        for report in used.reportJoins:
            source = make("bridge.ReportSource")
            make.refer(source, "join", report)
            make.own(connection, "sources", source)
    else:
        for join in used.joins:
            topic = make("bridge.Topic", name=str(join.name))
            make.refer(topic, "join", join)
            make.own(connection, "topics", topic)
    make.refer(connection, "map", used)
    owner = make("bridge.Bridge", name=BRIDGE_NAME, address="1.1.1")
    make.own(owner, "bridgeConnections", connection)
    whole = make("system.System", name=_SYSTEM)
    make.own(whole, "bridges", owner)
    return made_model(metamodels, whole, owner, connection)
