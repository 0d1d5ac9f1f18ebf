"""Runtime that ships with generated code: transports, JAUS core services, clients, bridges.

Copied into a generated workspace as the package ``jausml_runtime``. It needs the standard library
only; rclpy is imported by the ROS side of bridges, when one runs.

Generated code and its users may import the names of nine modules; all other modules may change:

- ``jausml_runtime``: components, bridges, their settings and callbacks;
- ``jausml_runtime.messages``: the messages of the core services;
- ``jausml_runtime.conversions``: conversions of values, and their types;
- ``jausml_runtime.conversions.arithmetic``: the functions of expressions;
- ``jausml_runtime.wire``: the parts of message classes;
- ``jausml_runtime.bridge.light_message``: the parts of light classes of ROS messages;
- ``jausml_runtime.bridge.messages.octets``: lists of single octets;
- ``jausml_runtime.bridge.ros.values``: checks of the messages and responses of nodes;
- ``jausml_runtime.virtual``: virtual time, for tests.
"""

from .base.address import JausAddress as JausAddress
from .base.api import API_VERSION as API_VERSION
from .base.api import ApiVersionError as ApiVersionError
from .base.api import JausError as JausError
from .base.api import require_api as require_api
from .base.settings import TransportKind as TransportKind
from .base.settings import TransportSettings as TransportSettings
from .base.settings import peers as peers
from .bridge.bridge import Bridge as Bridge
from .bridge.calls.calls import CallTranslation as CallTranslation
from .bridge.calls.services import JausToRosService as JausToRosService
from .bridge.calls.services import RosServiceToJaus as RosServiceToJaus
from .bridge.connections.command_answer import CommandAnswer as CommandAnswer
from .bridge.connections.connection import AnyConnection as AnyConnection
from .bridge.connections.events_to_ros import EventToTopics as EventToTopics
from .bridge.connections.joins import Join as Join
from .bridge.connections.named_places import NamedPlaces as NamedPlaces
from .bridge.connections.queries_to_ros import QueryToTopics as QueryToTopics
from .bridge.connections.report_join import ReportJoin as ReportJoin
from .bridge.connections.shaping import Shape as Shape
from .bridge.connections.to_jaus import TopicsToMessage as TopicsToMessage
from .bridge.connections.to_reports import TopicsToReport as TopicsToReport
from .bridge.connections.to_ros import MessageToTopics as MessageToTopics
from .bridge.connections.translations import Transcode as Transcode
from .bridge.connections.translations import ros_classes as ros_classes
from .bridge.diagnosing import Carried as Carried
from .bridge.ends.actions import ListAction as ListAction
from .bridge.ends.actions import Progress as Progress
from .bridge.ends.ends import BridgeSettings as BridgeSettings
from .bridge.ends.list_driver import ListAnswers as ListAnswers
from .bridge.ends.list_driver import ListMessages as ListMessages
from .bridge.ends.mission_driver import MissionMessages as MissionMessages
from .bridge.ends.parameters import AttributeParameter as AttributeParameter
from .bridge.ends.ros_side import RosSide as RosSide
from .bridge.ends.topics import Qos as Qos
from .bridge.ends.topics import RosService as RosService
from .bridge.ends.topics import Topic as Topic
from .bridge.ends.waypoint_driver import WaypointMessages as WaypointMessages
from .bridge.forms import differing_forms as differing_forms
from .bridge.guardian import Guardian as Guardian
from .bridge.handoff_bridge import HandoffBridge as HandoffBridge
from .bridge.lists.action_to_list import ActionToList as ActionToList
from .bridge.lists.list_to_action import ListToAction as ListToAction
from .bridge.messages.compiled import Core as Core
from .bridge.messages.limits import AbsentFieldError as AbsentFieldError
from .bridge.messages.limits import OutOfRangeError as OutOfRangeError
from .bridge.messages.limits import StaleJoinError as StaleJoinError
from .bridge.messages.limits import by_name as by_name
from .bridge.messages.limits import set_quaternion as set_quaternion
from .bridge.messages.limits import set_time as set_time
from .bridge.node_process import run_node as run_node
from .bridge.process import run_bridge as run_bridge
from .clients.command_client import Commander as Commander
from .clients.command_client import PendingCommand as PendingCommand
from .clients.control_session import ControlSession as ControlSession
from .clients.control_state import ControlState as ControlState
from .clients.discovery_client import FoundComponent as FoundComponent
from .clients.event_subscriber import EventSubscriber as EventSubscriber
from .clients.event_subscription import EventSubscription as EventSubscription
from .clients.found_peers import PeerQuerier as PeerQuerier
from .clients.found_peers import PeerSubscriber as PeerSubscriber
from .clients.greeter import Greeter as Greeter
from .clients.handoff_client import HandoffAnswer as HandoffAnswer
from .clients.handoff_client import HandoffClient as HandoffClient
from .clients.handoff_client import PendingHandoff as PendingHandoff
from .clients.list_client import ListEditor as ListEditor
from .clients.list_client import ListRequest as ListRequest
from .clients.peer_controller import PeerController as PeerController
from .clients.peer_search import PeerChoice as PeerChoice
from .clients.peer_search import PeerFinder as PeerFinder
from .clients.peer_search import PeerSearch as PeerSearch
from .clients.querier import Querier as Querier
from .clients.query import PendingQuery as PendingQuery
from .clients.resource_client import ResourceClient as ResourceClient
from .component.base import Component as Component
from .component.component import JausComponent as JausComponent
from .component.modelled import ModelledComponent as ModelledComponent
from .component.modelled import Simulation as Simulation
from .component.process import running_transport as running_transport
from .component.program import ComponentProgram as ComponentProgram
from .component.program import run_component as run_component
from .component.state_machine import Action as Action
from .component.state_machine import Condition as Condition
from .component.state_machine import Kind as Kind
from .component.state_machine import On as On
from .component.state_machine import State as State
from .component.state_machine import StateMachine as StateMachine
from .component.state_machine import all_of as all_of
from .component.state_machine import any_of as any_of
from .component.state_machine import negation as negation
from .conversions import ConversionError as ConversionError
from .messages.handoff import HandoffDecision as HandoffDecision
from .services.definitions import Completion as Completion
from .services.definitions import ComponentSettings as ComponentSettings
from .services.definitions import Guard as Guard
from .services.definitions import HandoffRequest as HandoffRequest
from .services.definitions import Scope as Scope
from .services.definitions import ServiceIdentity as ServiceIdentity
from .services.definitions import Status as Status
from .services.digital_resources import DigitalResourceService as DigitalResourceService
from .services.directory import Directory as Directory
from .services.handoff import HandoffService as HandoffService
from .services.list_elements import ListElement as ListElement
from .services.list_manager import ElementList as ElementList
from .services.list_manager import ListHolder as ListHolder
from .services.list_manager import ListManagerService as ListManagerService
from .services.list_manager import chain as chain
from .services.machine_states import MachineStatesService as MachineStatesService
from .services.time_of_day import TimeService as TimeService
from .transports.jtcp import JtcpTransport as JtcpTransport
from .transports.node_manager import NodeManagerTransport as NodeManagerTransport
from .transports.packets.packet import Priority as Priority
from .transports.transport import Transport as Transport
from .wire import DecodeError as DecodeError
from .wire import EncodeError as EncodeError
from .wire import Message as Message
