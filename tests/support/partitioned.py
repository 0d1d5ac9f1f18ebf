"""Robots of any size in one bridge, whose components and nodes are on several hosts."""

import random

HEAD = """\
import `jaus.core-1.1`
import mappings.velocity_state_sensor
import mappings.primitive_driver

"""


def robot(connections: int, hosts: int = 1, seed: int = 0) -> str:
    """Returns the text of a robot whose one bridge reports the speeds of many components.

    Each fourth connection commands a component; a few share what they ask for.
    """
    chance = random.Random(seed)
    text, carried, places = HEAD, "", [[] for _ in range(hosts)]
    for number in range(connections):
        where = places[chance.randrange(hosts)]
        if number % 4 == 3:
            name, peer = f"drive{number}", f"driver{number - number % 8}"
            how = "map: wrench_effort_stamped  direction: rosToJaus  silenceTimeout: 1"
            body = f"{how}  peers: {peer}"
            service, end = "PrimitiveDriver", "publisher"
        else:
            name, peer = f"speed{number}", f"sensor{number - number % 3}"
            rate = f"rate: {chance.randrange(5, 50)}"
            body = f"map: velocity_state_twist  exchange: periodicEvent  {rate}  peers: {peer}"
            service, end = "VelocityStateSensor", "subscription"
        if f"component {peer} " not in text:
            address = f"100.1.{2 + number % 250}" if number < 250 else f"100.2.{number - 248}"
            text += f"component {peer} {{ address: {address}  provides: {service} }}\n"
            chance.choice(places).append(peer)
        topic = f"topic: {name}  type: geometry_msgs/TwistStamped"
        text += f"node node_{name} {{ {end} {name} {{ {topic} }} }}\n"
        where.append(f"node_{name}")
        carried += f"    connection {name} {{ {body}  topic {name} }}\n"
    head = "address: 100.3.1  uses: VelocityStateSensor, PrimitiveDriver"
    text += f"bridge main {{\n    {head}\n{carried}}}\n"
    for number, names in enumerate(places):
        text += f'host h{number} {{ interface: "10.0.0.{number + 1}" }}\n'
        of_jaus = ", ".join(name for name in names if not name.startswith("node_"))
        of_ros = ", ".join(name for name in names if name.startswith("node_"))
        features = [f"components: {of_jaus}"] * bool(of_jaus) + [f"nodes: {of_ros}"] * bool(of_ros)
        if features:
            text += f"placement {{ host: h{number}  {'  '.join(features)} }}\n"
    return text
