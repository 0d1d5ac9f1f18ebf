"""Runtime that ships with generated code: transports, JAUS core services, clients, bridges.

Copied into a generated workspace as the package ``jausml_runtime``. It needs the standard library
only; rclpy is imported by the ROS side of bridges, when one runs.

What generated code and its users may import stands in nine modules, by name; whatever lies behind
them may move:

- ``jausml_runtime``: components, bridges and what they are made and told of;
- ``jausml_runtime.messages``: the messages of the core services;
- ``jausml_runtime.conversions``: conversions of values, and the values that they know;
- ``jausml_runtime.conversions.arithmetic``: the functions of expressions;
- ``jausml_runtime.wire``: what classes of messages are made of;
- ``jausml_runtime.bridge.light_message``: what light classes of ROS messages are made of;
- ``jausml_runtime.bridge.messages.octets``: lists of single octets;
- ``jausml_runtime.bridge.ros.values``: checks of what nodes publish and answer;
- ``jausml_runtime.virtual``: virtual time, for tests.
"""

from .base.address import JausAddress
from .base.api import API_VERSION, ApiVersionError, JausError, require_api
from .base.settings import TransportKind, TransportSettings, peers
from .bridge.bridge import Bridge
from .bridge.calls.calls import CallTranslation
from .bridge.calls.services import JausToRosService, RosServiceToJaus
from .bridge.connections.command_answer import CommandAnswer
from .bridge.connections.connection import AnyConnection
from .bridge.connections.events_to_ros import EventToTopics
from .bridge.connections.joins import Join
from .bridge.connections.queries_to_ros import QueryToTopics
from .bridge.connections.report_join import ReportJoin
from .bridge.connections.shaping import Shape
from .bridge.connections.to_jaus import TopicsToMessage
from .bridge.connections.to_reports import TopicsToReport
from .bridge.connections.to_ros import MessageToTopics
from .bridge.connections.translations import NamedPlaces, Transcode, ros_classes
from .bridge.diagnosing import Carried
from .bridge.ends.actions import ListAction, Progress
from .bridge.ends.ends import BridgeSettings
from .bridge.ends.list_driver import ListAnswers, ListMessages
from .bridge.ends.mission_driver import MissionMessages
from .bridge.ends.parameters import AttributeParameter
from .bridge.ends.ros_side import RosSide
from .bridge.ends.topics import Qos, RosService, Topic
from .bridge.ends.waypoint_driver import WaypointMessages
from .bridge.forms import differing_forms
from .bridge.guardian import Guardian
from .bridge.handoff_bridge import HandoffBridge
from .bridge.lists.action_to_list import ActionToList
from .bridge.lists.list_to_action import ListToAction
from .bridge.messages.compiled import Core
from .bridge.messages.limits import (
    AbsentFieldError,
    OutOfRangeError,
    StaleJoinError,
    by_name,
    set_quaternion,
    set_time,
)
from .bridge.node_process import run_node
from .bridge.process import run_bridge
from .clients.command_client import Commander, PendingCommand
from .clients.control_session import ControlSession
from .clients.control_state import ControlState
from .clients.discovery_client import FoundComponent
from .clients.event_subscriber import EventSubscriber
from .clients.event_subscription import EventSubscription
from .clients.found_peers import PeerQuerier, PeerSubscriber
from .clients.greeter import Greeter
from .clients.handoff_client import HandoffAnswer, HandoffClient, PendingHandoff
from .clients.list_client import ListEditor, ListRequest
from .clients.peer_controller import PeerController
from .clients.peer_search import PeerChoice, PeerFinder, PeerSearch
from .clients.querier import Querier
from .clients.query import PendingQuery
from .clients.resource_client import ResourceClient
from .component.base import Component
from .component.component import JausComponent
from .component.modelled import ModelledComponent, Simulation
from .component.process import running_transport
from .component.program import ComponentProgram, run_component
from .component.state_machine import (
    Action,
    Condition,
    Kind,
    On,
    State,
    StateMachine,
    all_of,
    any_of,
    negation,
)
from .conversions import ConversionError
from .messages.handoff import HandoffDecision
from .services.definitions import (
    Completion,
    ComponentSettings,
    Guard,
    HandoffRequest,
    Scope,
    ServiceIdentity,
    Status,
)
from .services.digital_resources import DigitalResourceService
from .services.directory import Directory
from .services.handoff import HandoffService
from .services.list_elements import ListElement
from .services.list_manager import ElementList, ListHolder, ListManagerService, chain
from .services.machine_states import MachineStatesService
from .services.time_of_day import TimeService
from .transports.jtcp import JtcpTransport
from .transports.node_manager import NodeManagerTransport
from .transports.packets.packet import Priority
from .transports.transport import Transport
from .wire import DecodeError, EncodeError, Message

__all__ = [
    "API_VERSION",
    "AbsentFieldError",
    "Action",
    "ActionToList",
    "AnyConnection",
    "ApiVersionError",
    "AttributeParameter",
    "Bridge",
    "BridgeSettings",
    "CallTranslation",
    "Carried",
    "CommandAnswer",
    "Commander",
    "Completion",
    "Component",
    "ComponentProgram",
    "ComponentSettings",
    "Condition",
    "ControlSession",
    "ControlState",
    "ConversionError",
    "Core",
    "DecodeError",
    "DigitalResourceService",
    "Directory",
    "ElementList",
    "EncodeError",
    "EventSubscriber",
    "EventSubscription",
    "EventToTopics",
    "FoundComponent",
    "Greeter",
    "Guard",
    "Guardian",
    "HandoffAnswer",
    "HandoffBridge",
    "HandoffClient",
    "HandoffDecision",
    "HandoffRequest",
    "HandoffService",
    "JausAddress",
    "JausComponent",
    "JausError",
    "JausToRosService",
    "Join",
    "JtcpTransport",
    "Kind",
    "ListAction",
    "ListAnswers",
    "ListEditor",
    "ListElement",
    "ListHolder",
    "ListManagerService",
    "ListMessages",
    "ListRequest",
    "ListToAction",
    "MachineStatesService",
    "Message",
    "MessageToTopics",
    "MissionMessages",
    "ModelledComponent",
    "NamedPlaces",
    "NodeManagerTransport",
    "On",
    "OutOfRangeError",
    "PeerChoice",
    "PeerController",
    "PeerFinder",
    "PeerQuerier",
    "PeerSearch",
    "PeerSubscriber",
    "PendingCommand",
    "PendingHandoff",
    "PendingQuery",
    "Priority",
    "Progress",
    "Qos",
    "Querier",
    "QueryToTopics",
    "ReportJoin",
    "ResourceClient",
    "RosService",
    "RosServiceToJaus",
    "RosSide",
    "Scope",
    "ServiceIdentity",
    "Shape",
    "Simulation",
    "StaleJoinError",
    "State",
    "StateMachine",
    "Status",
    "TimeService",
    "Topic",
    "TopicsToMessage",
    "TopicsToReport",
    "Transcode",
    "Transport",
    "TransportKind",
    "TransportSettings",
    "WaypointMessages",
    "all_of",
    "any_of",
    "by_name",
    "chain",
    "differing_forms",
    "negation",
    "peers",
    "require_api",
    "ros_classes",
    "run_bridge",
    "run_component",
    "run_node",
    "running_transport",
    "set_quaternion",
    "set_time",
]
