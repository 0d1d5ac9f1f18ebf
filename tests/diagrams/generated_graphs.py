"""Systems by chance: the same number makes the same graph."""

import random

from jausml.views.diagrams.graph import Edge, End, Graph, Group, Node, Port

_COLUMNS = {"component": 0, "bridge": 1, "node": 2}
_LABELS = ("command", "event, 10 Hz", "query, 1 Hz", "event on change", "service")


def generated(number):
    """Returns a graph of a system: components, bridges and nodes on hosts, and connections."""
    chance = random.Random(number)
    hosts = [f"host{index}" for index in range(chance.choice((0, 1, 1, 2, 3)))]
    kinds = {
        "component": chance.randint(1, 4),
        "bridge": chance.randint(1, 3),
        "node": chance.randint(1, 4),
    }
    boxes = {
        f"{kind}{index}": (kind, chance.choice(["", *hosts]) if hosts else "")
        for kind, count in kinds.items()
        for index in range(count)
    }
    rows = {name: {} for name in boxes}
    edges = []

    def row(box, name):
        rows[box].setdefault(name, Port(f"{box}!{name}", name, "Type" * chance.randint(1, 4)))
        return End(box, f"{box}!{name}")

    def join(one, other, kind, label):
        ends = (one, other) if chance.random() < 0.5 else (other, one)
        edges.append(Edge(f"e{len(edges)}", *ends, kind, kind, (label,) if label else ()))

    of_kind = {kind: [name for name, (own, _) in boxes.items() if own == kind] for kind in kinds}
    for index in range(chance.randint(2, 24)):
        here = row(chance.choice(of_kind["bridge"]), f"connection{index}")
        for other in chance.choices(of_kind["component"], k=chance.choice((1, 1, 1, 2))):
            there = row(other, f"message{chance.randint(0, index)}")
            join(there, here, "message", chance.choice(_LABELS))
        for other in chance.choices(of_kind["node"], k=chance.choice((1, 1, 2))):
            join(here, row(other, f"/topic{chance.randint(0, index)}"), "topic", "")
    for kind, column in (("component", "message"), ("node", "topic")):
        if len(of_kind[kind]) > 1 and chance.random() < 0.6:
            one, other = chance.sample(of_kind[kind], 2)
            join(row(one, "own"), row(other, "own"), column, chance.choice(("", "event, 10 Hz")))
    nodes = tuple(
        Node(
            name, kind, name, f"{kind} of chance", tuple(rows[name].values()), host, _COLUMNS[kind]
        )
        for name, (kind, host) in boxes.items()
    )
    used = {host for _, host in boxes.values()}
    groups = tuple(Group(host, "host", f"host {host}") for host in hosts if host in used)
    return Graph("system", f"system {number}", nodes, groups, tuple(edges))
