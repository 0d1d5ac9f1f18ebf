"""Services and actions in recordings: what their topics say, in the words of others."""

from pathlib import Path

import needs
import pytest
from recordings import PATIENCE, wait_for
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from jausml.language.interfaces import Installation
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages.defined import DefinedCatalogue
from jausml.live.recording.mcap_files import TrafficFilter, copied
from jausml.live.recording.mcap_reading import McapRecording
from jausml.live.recording.recorder import Recorder, RecordingFiles, SplitLimits, topics_of
from jausml.live.recording.ros_definitions import installed_definition
from jausml.live.recording.ros_topics import RosTopics

FLEET = Path(__file__).resolve().parents[2] / "models" / "examples" / "fleet" / "fleet.ros2jaus"
CALLS = "/switch/_service_event"


def read(path):
    return read_models([path], notations=NOTATIONS, allow_outside=True).model


@pytest.fixture
def installation(tmp_path):
    """One with an action."""
    for package, kind, name, text in (
        ("yard_msgs", "action", "Dig", "uint8 depth\n---\n---\nPoint where\nfloat32 left\n"),
        ("yard_msgs", "msg", "Point", "float64 x\n"),
        ("yard_msgs", "srv", "Stop", "---\nbool done\n"),
        ("unique_identifier_msgs", "msg", "UUID", "uint8[16] uuid\n"),
        ("builtin_interfaces", "msg", "Time", "int32 sec\nuint32 nanosec\n"),
        ("service_msgs", "msg", "ServiceEventInfo", "uint8 event_type\n"),
    ):
        folder = tmp_path / package / kind
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.{kind}").write_text(text, encoding="utf-8")
    return Installation([tmp_path])


def fields(text, name):
    """What rosbags understands of a definition: the names of the fields of each type."""
    found = get_types_from_msg(text, name)
    return {
        key.rpartition("/")[2]: [field_name for field_name, _ in value[1]]
        for key, value in found.items()
    }


CALL = {"ServiceEventInfo": ["event_type"]}
GOAL_CALL = {**CALL, "UUID": ["uuid"]}
PARTS = ["info", "request", "response"]
DEFINITIONS = {
    "srv/Stop_Event": {
        "Stop_Event": PARTS,
        "Stop_Request": ["structure_needs_at_least_one_member"],
        "Stop_Response": ["done"],
        **CALL,
    },
    "action/Dig_FeedbackMessage": {
        "Dig_FeedbackMessage": ["goal_id", "feedback"],
        "Dig_Feedback": ["where", "left"],
        "Point": ["x"],
        "UUID": ["uuid"],
    },
    "action/Dig_SendGoal_Event": {
        "Dig_SendGoal_Event": PARTS,
        "Dig_SendGoal_Request": ["goal_id", "goal"],
        "Dig_SendGoal_Response": ["accepted", "stamp"],
        "Dig_Goal": ["depth"],
        "Time": ["sec", "nanosec"],
        **GOAL_CALL,
    },
    "action/Dig_GetResult_Event": {
        "Dig_GetResult_Event": PARTS,
        "Dig_GetResult_Request": ["goal_id"],
        "Dig_GetResult_Response": ["status", "result"],
        "Dig_Result": ["structure_needs_at_least_one_member"],
        **GOAL_CALL,
    },
}


@pytest.mark.parametrize("name", DEFINITIONS)
def test_calls_of_services_and_actions_are_defined(installation, name):
    text = installed_definition(f"yard_msgs/{name}", installation)
    assert fields(text, f"yard_msgs/msg/{name.partition('/')[2]}") == DEFINITIONS[name]


@pytest.mark.parametrize("name", ["srv/Stop", "srv/Stop_Evil", "action/Dug_FeedbackMessage", "x"])
def test_what_is_no_topic_has_no_definition(installation, name):
    assert installed_definition(f"yard_msgs/{name}", installation) == ""


def test_topics_of_a_model_are_those_of_its_calls_too(request):
    live = request.config.rootpath / "tests" / "live"
    assert "/switch_lamp/_service_event" in topics_of(read(live / "services.ros2jaus"))
    assert "/diagnostics" in topics_of(read(live / "services.ros2jaus"))
    lists = topics_of(read(live / "waypoint_lists.ros2jaus"))
    topics = ("feedback", "status", "send_goal/_service_event", "get_result/_service_event")
    assert {f"/robot/follow_waypoints/_action/{topic}" for topic in topics} <= set(lists)


@pytest.mark.live
def test_calls_are_recorded_where_a_node_publishes_them(tmp_path, monkeypatch):
    needs.ask("rclpy")
    from ports import free_domain

    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    path, whole = tmp_path / "calls.mcap", tmp_path / "whole.mcap"
    recorder = Recorder(
        RecordingFiles(path, SplitLimits()), DefinedCatalogue(read(FLEET)), {}, TrafficFilter()
    )
    ros = RosTopics(TrafficFilter(topics=("/switch/*",)))
    with Introspected() as node, recorder.kept(0.1, ros.repeat_latched):
        ros.open()
        ros.begin(None, recorder.take_topic)
        try:
            wait_for(lambda: node.listeners() > 0, "recorder")
            node.call(True)
            wait_for(lambda: recorder.topics[CALLS] == 4, "calls in the file")
        finally:
            ros.stop()
    assert not ros.missing
    with whole.open("wb") as stream:
        copied(McapRecording(str(path)).messages(), stream, ros_only=True)
    with Reader(whole) as reader:
        (connection,) = reader.connections
        assert (connection.topic, connection.msgtype) == (CALLS, "std_srvs/srv/SetBool_Event")
        store = get_typestore(Stores.EMPTY)
        name = "std_srvs/msg/SetBool_Event"
        store.register(get_types_from_msg(connection.msgdef.data, name))
        found = [store.deserialize_cdr(data, name) for _, _, data in reader.messages()]
    kinds = {event.info.event_type: event for event in found}
    assert sorted(kinds) == [0, 1, 2, 3]  # sent and received, by the client and by the server
    assert kinds[1].request[0].data
    assert kinds[2].response[0].message == "on"


class Introspected:
    """A node with a service and its client, whose calls are published."""

    def __enter__(self):
        import rclpy
        from rclpy.context import Context
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.qos import qos_profile_system_default
        from rclpy.service_introspection import ServiceIntrospectionState
        from std_srvs.srv import SetBool

        self._context = Context()
        rclpy.init(context=self._context, args=[])
        self._node = rclpy.create_node("switch_node", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._client = self._node.create_client(SetBool, "/switch")
        service = self._node.create_service(SetBool, "/switch", _switched)
        for endpoint in (service, self._client):
            state = ServiceIntrospectionState.CONTENTS
            endpoint.configure_introspection(
                self._node.get_clock(), qos_profile_system_default, state
            )
        return self

    def __exit__(self, *_):
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def listeners(self):
        self._executor.spin_once(timeout_sec=0.05)
        return self._node.count_subscribers(CALLS)

    def call(self, value):
        from std_srvs.srv import SetBool

        assert self._client.wait_for_service(PATIENCE)
        future = self._client.call_async(SetBool.Request(data=value))
        self._executor.spin_until_future_complete(future, PATIENCE)
        assert future.done()


def _switched(request, response):
    response.success, response.message = True, "on" if request.data else "off"
    return response
