"""A counter-example as a test in virtual time, which uses the generated packages."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import groupby

from jausml.language.metamodel.classes import bridge
from jausml.language.model import Model
from jausml.language.semantics.connections.topics import resolve_topic
from jausml.model_checking.bridge_products import (
    PUBLISHER,
    RADIO,
    CommandingProduct,
    ObeyingProduct,
)
from jausml.model_checking.checking import CounterExample, Moment
from jausml.model_checking.runtime_machines import EMERGENCY_CLIENT
from jausml.model_checking.search import LATE_STOP, LIVELOCK, Product
from jausml.model_checking.systems import Subject
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.views import BridgeView, bridge_views
from jausml_generators.common.components import address_call
from jausml_generators.python.names import snake_case

_HEAD = '''"""A counter-example of `jausml model-check` to {name}, in virtual time.

It fails as long as what it found can happen: {message}.

Run it beside what `jausml generate --all` makes:
PYTHONPATH=$(echo ws/* | tr ' ' :) python -m pytest FILE
"""

from jausml_runtime import ComponentSettings, Guard, JausAddress, JausComponent, ServiceIdentity
from jausml_runtime import messages as core
from jausml_runtime.virtual import VirtualWorld
from {package} import messages, ros_types
from {package}.{package} import {class_name}
'''

# Functions of a test that make its clients.
CLIENTS = '''

def services(minor):
    """Returns the core services of a component."""
    names = ("Transport", "Events", "AccessControl", "Management")
    return tuple(ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, minor) for name in names)


def client(transport, address, name):
    """Returns a client that runs."""
    made = JausComponent(transport, address, name=name, services=services(1))
    made.start()
    return made

'''

_LONG = 60.0  # seconds that stand for what has no end

_PEER = '''
class Peer(JausComponent):
    """Stands for the peer: it moves from a command on until the stop, or until it is not Ready."""

    moves = False

    def on_not_ready(self):
        """Stop."""
        self.moves = False

    def on_control_lost(self):
        """Stop."""
        self.moves = False

'''


_TWO_RADIOS = """\
beside, radio = world.transport(), world.transport()
peer = Peer(beside, {at}, name="peer", services=services({minor}), settings={settings})
bridge = {class_name}()

def take(_message, _sender):
    peer.moves = bridge.{name}.stopped is None

peer.handle(messages.{message}, take, when=Guard.{guard})
peer.start()
bridge.open(world.ros_node("{node}"), radio)
rival = client(beside, JausAddress(64000, 1, 1), "{rival}")
emergency = client(beside, JausAddress(64000, 1, 2), "{emergency}")
inside = client(radio, JausAddress(64000, 1, 3), "{emergency}")
world.run_for({tick!r})
"""


def virtual_test(model: Model, subject: Subject, example: CounterExample) -> str | None:
    """Returns a test module; None for counter-examples of machines and lists."""
    product, connection = subject.product, subject.element
    if not isinstance(product, (ObeyingProduct, CommandingProduct)):
        return None
    if not isinstance(connection, bridge.Connection):
        return None
    view = next(view for view in bridge_views(model) if view.bridge is connection.eContainer())
    own = next(candidate for candidate in view.connections if candidate.connection is connection)
    message = " ".join(example.message.split())
    names = {"package": view.package, "class_name": view.class_name}
    lines = [_HEAD.format(name=subject.name, message=message, **names), CLIENTS]
    if isinstance(product, CommandingProduct):
        lines.append(_PEER)
        body = _commanding(product, subject, example, view, own)
    else:
        body = _obeying(product, subject, example, view, own)
    lines.append(f"\ndef test_{snake_case(subject.name.replace('.', '_').replace(' ', '_'))}():\n")
    lines.append(f'    """{message[:1].upper()}{message[1:]}."""\n')
    lines.append("    with VirtualWorld() as world:\n")
    lines += [f"        {line}\n" for line in body]
    return "".join(lines)


def _obeying(
    product: ObeyingProduct,
    subject: Subject,
    example: CounterExample,
    view: BridgeView,
    own: ConnectionView,
) -> Iterator[str]:
    yield f"bridge = {view.class_name}()"
    yield f'bridge.open(world.ros_node("{view.name}"), world.transport())'
    yield "address = bridge.settings.address"
    actors = {
        name: f"client_{number}" for number, name in enumerate((*product.clients, EMERGENCY_CLIENT))
    }
    peers = {str(peer.name): peer for peer in own.connection.peers}
    for number, (name, variable) in enumerate(actors.items(), 1):
        at = address_call(peers[name]) if name in peers else f"JausAddress(64000, 1, {number})"
        yield f'{variable} = client(world.transport(), {at}, "{name}")'
    yield f"world.run_for({subject.tick!r})"

    def done(moment: Moment) -> str:
        step = moment.step
        if step.actor == product.bridge:
            return _of_the_bridge(step.what)
        sent = f"messages.{own.message_name}()"
        if step.what != product.command:
            sent = core_message(step.what, product.services.authorities.get(step.actor, 0))
        return f"{actors[step.actor]}.send({sent}, address)"

    yield from _steps(example, done)
    yield from _for_ever(product, example)
    if example.rule == LATE_STOP:
        yield f"assert bridge.{own.name}.stopped is not None"
    else:
        free = f"bridge.component.controller in (None, {actors[product.clients[0]]}.address)"
        yield f"assert {free}" if example.rule == LIVELOCK else f"assert bridge.{own.name}.stopped"


def _commanding(
    product: CommandingProduct,
    subject: Subject,
    example: CounterExample,
    view: BridgeView,
    own: ConnectionView,
) -> Iterator[str]:
    connection = own.connection
    owner, peers = view.bridge, {str(component.name): component for component in connection.peers}
    peer = peers.get(product.peer)
    at = "JausAddress(64000, 1, 9)" if peer is None else address_call(peer)
    lapse = round(product.services.timeout * subject.tick)
    yield from _TWO_RADIOS.format(
        at=at,
        minor=0 if product.services.is_1_0 else 1,
        settings=f"ComponentSettings({product.services.default_authority}, {lapse})",
        class_name=view.class_name,
        name=own.name,
        message=own.message_name,
        guard=product.connection.guard,
        node=view.name,
        rival=product.rival,
        emergency=EMERGENCY_CLIENT,
        tick=subject.tick,
    ).splitlines()
    topics = (end.name for end in connection.topics if end.join is None)
    topic = resolve_topic(str(next(topics)), owner.namespace or "", str(owner.name))

    def done(moment: Moment) -> str:
        step = moment.step
        if step.actor == PUBLISHER:
            class_name = f"ros_types.{own.ros_name}"
            return f'world.ros.publish("{topic}", {class_name}, {class_name}().to_cdr())'
        if step.actor == RADIO:
            return "radio.cut()" if step.what == "is lost" else "radio.restore()"
        if step.actor == product.bridge:
            return _of_the_bridge(step.what)
        if step.actor == product.peer:
            return 'peer.fail("it is told to")'
        is_inside = step.receiver == product.bridge
        sender = "rival" if step.actor == product.rival else "emergency"
        sender, to = ("inside", "bridge.settings.address") if is_inside else (sender, at)
        sent = core_message(step.what, product.services.authorities.get(step.actor, 0))
        return f"{sender}.send({sent}, {to})"

    yield from _steps(example, done)
    free = "peer.controller in (None, bridge.settings.address)"
    yield f"assert {free}" if example.rule == LIVELOCK else "assert not peer.moves"


def _for_ever(product: Product, example: CounterExample) -> Iterator[str]:
    if example.repeats or (example.rule == LATE_STOP and not product.bound):
        yield f"world.run_for({_LONG})  # for ever, as it seems"


def _of_the_bridge(what: str) -> str:
    if what == "fails":
        return 'bridge.component.fail("it is told to")'
    return f"bridge.set_active({what == 'is activated'})"


def core_message(name: str, authority: int) -> str:
    """Returns the expression for a message of the core services."""
    arguments = {"RequestControl": f"authority_code={authority}"}
    arguments |= dict.fromkeys(("SetEmergency", "ClearEmergency"), "emergency_code=1")
    return f"core.{name}({arguments.get(name, '')})"


def _steps(example: CounterExample, done: Callable[[Moment], str]) -> Iterator[str]:
    before = 0.0
    for is_tick, group in groupby(
        example.moments, key=lambda example_moment: example_moment.step.is_tick
    ):
        moments = list(group)
        if is_tick:
            after = moments[-1].seconds
            yield f"world.run_for({round(after - before, 3)!r})"
            before = after
            continue
        for moment in moments:
            yield done(moment)
            # What was sent arrives only while the world runs, if for no time.
            yield "world.run_for(0)"
