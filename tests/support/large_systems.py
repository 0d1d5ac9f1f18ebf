"""Systems of any size: groups of four components and a bridge with eight connections."""

_CONNECTION = """\
    connection velocity{number} {{
        map: velocity_state_twist
        peers: {peer}
        rate: {rate}
        topic twist{group}_{number}
    }}
"""


def large_system(groups: int, hosts: int = 0) -> str:
    """Returns the text of a system of 21 elements a group, whose groups run on hosts in turn."""
    text = "import mappings.velocity_state_sensor\n"
    placed: list[list[str]] = [[] for _ in range(hosts)]
    for group in range(groups):
        node = f"{100 + group // 60}.{1 + group % 60}"
        vehicles = [f"vehicle{group}_{number}" for number in range(4)]
        for number, name in enumerate(vehicles):
            address = f"address: {node}.{2 + number}"
            text += (
                f"component {name} {{ {address}  provides: VelocityStateSensor  external: true }}\n"
            )
        connections = "".join(
            _CONNECTION.format(
                group=group, number=number, peer=vehicles[number % 4], rate=5 + number
            )
            for number in range(8)
        )
        text += f"bridge bridge{group} {{\n    address: {node}.200\n{connections}}}\n"
        if hosts:
            placed[group % hosts] += [*vehicles, f"bridge{group}"]
    for number, names in enumerate(placed):
        text += f"host h{number} {{ }}\n"
        text += (
            f"placement {{ host: h{number}  components: {', '.join(names)} }}\n" if names else ""
        )
    return text
