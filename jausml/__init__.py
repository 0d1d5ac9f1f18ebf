"""jausml: generates ROS 2 <-> JAUS bridges and JAUS components from models.

In Python: `read`, `validate` and `generate` for models, `decode` and `encode` for messages, and
`Component` and `AsyncComponent` to speak with JAUS components (docs/how-to/python.md).
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

_HOMES = {
    "AsyncComponent": "jausml.live.api.aio",
    "AsyncSubscription": "jausml.live.api.aio",
    "Component": "jausml.live.api.component",
    "ComponentStatus": "jausml.live.api.component",
    "MessageError": "jausml.live.messages",
    "ModelError": "jausml.live.api.models",
    "NoAnswer": "jausml.live.peers.query_client",
    "Received": "jausml.live.api.messages",
    "Refused": "jausml.live.peers.query_client",
    "Subscription": "jausml.live.api.messages",
    "decode": "jausml.live.api.messages",
    "encode": "jausml.live.api.messages",
    "generate": "jausml.live.api.models",
    "read": "jausml.live.api.models",
    "validate": "jausml.live.api.models",
}
"""Where the names of the interface stand. They are loaded when used: tools start quickly."""

__all__ = ["__version__", *_HOMES]  # noqa: PLE0604 - names of the interface, all of them


def __getattr__(name: str) -> Any:
    """Returns a name of the interface (PEP 562)."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'jausml' has no attribute {name!r}")
    return getattr(import_module(home), name)
