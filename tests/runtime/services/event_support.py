"""A provider of events, and what subscribes to them."""

from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.event_client import EventClient
from jausml.runtime.messages import (
    QueryHeartbeatPulse,
    QueryStatus,
    ReportHeartbeatPulse,
    ReportStatus,
)

PROVIDER = JausAddress(1, 1, 1)


class Inbox(list):
    """Reports of one subscription."""

    def __call__(self, report, sender):
        assert sender == PROVIDER
        self.append(report)


def provider(world, **settings):
    return world.started(str(PROVIDER), **settings)


def pulses(client, inbox, **named):
    return client.subscribe(PROVIDER, QueryHeartbeatPulse(), ReportHeartbeatPulse, inbox, **named)


def statuses(client, inbox, **named):
    return client.subscribe(PROVIDER, QueryStatus(), ReportStatus, inbox, **named)


def kill(world, component):
    """Ends a component as a crash does: without a word."""
    world.detach(component.address)
    component._jaus_events.stop()
    component._jaus_running = False
    component.part(EventClient)._component = world.component("77.7.7")
    for stream in list(component.part(EventClient)._streams.values()):
        stream._timer.cancel()
        stream._silence_timer.cancel()
