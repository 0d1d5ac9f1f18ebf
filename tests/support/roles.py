"""What the processes of live tests have in common: services, lines of JSON, how they are run.

For the processes alone, which have the runtime of a generated workspace on their module path.
"""

import json
import sys
import threading
from collections.abc import Callable, Sequence

from jausml_runtime import (
    ComponentProgram,
    ComponentSettings,
    JausAddress,
    ServiceIdentity,
    run_component,
)

CONTROLLED = ("Transport", "Events", "AccessControl", "Management")
FOUND = (*CONTROLLED, "Discovery")

_OUTPUT = threading.Lock()


def core(*names: str) -> list[ServiceIdentity]:
    """Core services, version 1.1."""
    return [ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1) for name in names]


def say(kind: str, **facts: object) -> None:
    """Tells the test of something in one line of JSON."""
    with _OUTPUT:
        sys.stdout.write(json.dumps({"kind": kind, **facts}) + "\n")
        sys.stdout.flush()


def run(
    component: Callable[..., object],
    name: str,
    address: str,
    arguments: Sequence[str] | None = None,
    **settings: object,
) -> int:
    """Runs a component until a signal; `settings` are those of ComponentSettings."""
    program = ComponentProgram(
        name=name,
        description=f"The {name} of a live test.",
        address=JausAddress.parse(address),
        settings=ComponentSettings(**settings),
    )
    return run_component(component, program, arguments)
