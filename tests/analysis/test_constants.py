"""The figures that the analysis reads in the files of the runtime are those that it runs with."""

import needs

from jausml.runtime.base.settings import MAX_FRAGMENT_SIZE, TransportSettings
from jausml.runtime.bridge.ends.parameters import QUEUE_AGE_LIMIT
from jausml.runtime.clients.controlled_target import RENEWALS
from jausml.runtime.clients.event_client import EVENT_HEADER
from jausml.runtime.services.definitions import MAX_EVENT_RATE, ComponentSettings
from jausml.runtime.services.events import _EVENT
from jausml.runtime.transports.packets import messenger, outgoing
from jausml.runtime.transports.packets.packet import EMPTY_MESSAGE_SIZE
from jausml.views.analysis.sizes import runtime_constants


def test_constants_are_those_of_the_runtime():
    found = runtime_constants()
    transport, component = TransportSettings(), ComponentSettings()
    assert found.empty_message == EMPTY_MESSAGE_SIZE
    assert found.largest_fragment == MAX_FRAGMENT_SIZE
    assert found.most_small_fragments == outgoing.MAX_SMALL_FRAGMENTS
    assert found.at_once == messenger.AT_ONCE
    assert found.held_by_peers == messenger.HELD_BY_PEERS
    assert found.largest_message == transport.reassembly_limit
    assert found.event_header == EVENT_HEADER == _EVENT.size
    assert found.acknowledge_timeout == transport.acknowledge_timeout
    assert found.acknowledge_retries == transport.acknowledge_retries
    assert found.event_rate_min == component.event_rate_min
    assert found.highest_event_rate == component.event_rate_max == MAX_EVENT_RATE
    assert found.check_interval == component.check_interval
    assert found.watch_interval == component.watch_interval
    assert found.renewals == RENEWALS
    assert found.queue_age_limit == QUEUE_AGE_LIMIT


def test_the_least_depth_is_that_of_the_ros_side():
    needs.ask("rclpy")
    from jausml.runtime.bridge.ros import parameters

    assert runtime_constants().least_depth == parameters.LEAST_DEPTH
