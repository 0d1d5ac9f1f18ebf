"""Servers and clients of ROS services, on rclpy.

The executor takes requests and responses on its thread and passes them to the loop, as bytes. A
waitable takes requests instead of the server class of rclpy, which would keep a coroutine for each
request under way, for the executor to poll.
"""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import importlib
from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.type_support import check_is_valid_srv_type
from rclpy.waitable import NumberOfEntities, Waitable

from ...base.loop import Loop
from ..ends.topics import RosService
from ..light_message import installed_class
from .internals import internals
from .introspection import introspection
from .node import NodePart, RosNode
from .parameters import as_parameter_error

Reply = Callable[[bytes], None]
TakeRequest = Callable[[bytes, Reply], None]
TakeResponse = Callable[[bytes], None]

_PROFILE = QoSProfile(depth=128)  # reliable and volatile, for more calls than are under way


class NodeServices(NodePart):
    """The services of one node."""

    def __init__(self, ros: RosNode) -> None:
        self._node = ros.node
        self._loop = ros.loop
        self._introspection = ros.part(introspection)
        self._served: list[_Served] = []
        self._clients: list[Any] = []

    def serve(self, service: RosService, take: TakeRequest) -> None:
        """Serves a service; calls `take` on the loop with each request and its reply function."""
        kind = _installed(service)
        with as_parameter_error(f"service {service.name!a}: "), self._node.handle:
            profile = _PROFILE.get_c_qos_profile()
            handle = internals.Service(self._node.handle, kind, service.name, profile)
        served = _Served(self._node.default_callback_group, handle, kind, self._loop, take)
        self._served.append(served)
        self._node.add_waitable(served)
        self._introspection.add(served)

    def client(self, service: RosService) -> NodeClient:
        """Returns a client of a service."""
        kind = _installed(service)
        with as_parameter_error(f"service {service.name!a}: "):
            client = self._node.create_client(kind, service.name, qos_profile=_PROFILE)
        self._clients.append(client)
        self._introspection.add(client)
        return NodeClient(client, kind, self._loop)

    def destroy(self) -> None:
        """Destroys all servers and clients."""
        for service in self._served:
            self._node.remove_waitable(service)
            service.handle.destroy_when_not_in_use()
        for client in self._clients:
            self._node.destroy_client(client)


class NodeClient:
    """Calls one service."""

    def __init__(self, client: Any, kind: Any, loop: Loop) -> None:
        """Made by `NodeServices.client`."""
        self._client = client
        self._kind = kind
        self._loop = loop

    def is_ready(self) -> bool:
        """Returns whether the service has a server."""
        return bool(self._client.service_is_ready())

    def call(self, request: bytes, take: TakeResponse) -> Callable[[], None]:
        """Sends a request; `take` is called on the loop. Returns a function that drops the call."""
        future = self._client.call_async(deserialize_message(request, self._kind.Request))
        future.add_done_callback(partial(self._take_response, take))
        return partial(self._client.remove_pending_request, future)

    def _take_response(self, take: TakeResponse, future: Any) -> None:
        """Passes a response to the loop; on the thread of the executor, which must not fail."""
        if future.cancelled() or future.exception() is not None:
            return
        response = serialize_message(future.result())
        self._loop.call_soon(partial(take, response))


class _Served(Waitable):
    """A service whose requests the loop takes."""

    def __init__(self, group: Any, handle: Any, kind: Any, loop: Loop, take: TakeRequest) -> None:
        super().__init__(group)
        self.handle = handle
        self._kind = kind
        self._loop = loop
        self._take = take
        self._index: int | None = None

    def configure_introspection(self, clock: Any, profile: QoSProfile, state: Any) -> None:
        """Configures introspection, as services of rclpy do."""
        with self.handle:
            self.handle.configure_introspection(clock.handle, profile.get_c_qos_profile(), state)

    def get_num_entities(self) -> Any:
        return NumberOfEntities(num_services=1)

    def add_to_wait_set(self, wait_set: Any) -> None:
        with self.handle:
            self._index = wait_set.add_service(self.handle)

    def is_ready(self, wait_set: Any) -> bool:
        return self._index is not None and bool(wait_set.is_ready("service", self._index))

    def take_data(self) -> Any:
        with self.handle:
            return self.handle.service_take_request(self._kind.Request)

    async def execute(self, taken: Any) -> None:
        request, header = taken or (None, None)
        if header is None:
            return
        data = serialize_message(request)
        reply = partial(self._reply, header.request_id)
        self._loop.call_soon(lambda: self._take(data, reply))

    def _reply(self, request_id: Any, data: bytes) -> None:
        response = deserialize_message(data, self._kind.Response)
        with self.handle:
            self.handle.service_send_response(response, request_id)

    def __enter__(self) -> None:
        self.handle.__enter__()

    def __exit__(self, *error: object) -> None:
        self.handle.__exit__(*error)


def _installed(service: RosService) -> Any:
    """Returns the class of a service; raises RosTypeError if it differs from the model."""
    for part in (service.request, service.response):
        installed_class(part)
    package, kind, name = service.type_name.split("/")
    service_class = getattr(importlib.import_module(f"{package}.{kind}"), name)
    check_is_valid_srv_type(service_class)  # imports its type support
    return service_class
