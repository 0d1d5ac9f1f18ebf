"""A process of one component with the core services, as a generated one is made."""

import sys

from jausml.runtime import JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.component.program import ComponentProgram, run_component

CORE = ("Transport", "Events", "AccessControl", "Management", "Liveness", "Discovery")


class Plain(JausComponent):
    """Says on standard output when it initialises."""

    def __init__(self, transport, address, settings):
        services = [ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1) for name in CORE]
        super().__init__(transport, address, name="plain", services=services, settings=settings)

    def on_initialize(self):
        sys.stdout.write("initialize\n")
        sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(run_component(Plain, ComponentProgram("plain", "For tests.", JausAddress(1, 1, 1))))
