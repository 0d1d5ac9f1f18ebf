"""`jausml doctor`: looks at this machine."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from jausml.cli.live.recordings import transport_settings
from jausml.cli.shared.files import PROBLEMS, counted
from jausml.cli.shared.models import project_files, read, reading_options
from jausml.cli.shared.options import (
    format_option,
    interface_option,
    multicast_group_option,
    peer_option,
    port_option,
    quiet_option,
)
from jausml.cli.shared.terminal import painted

if TYPE_CHECKING:
    from jausml.language.model.project import Reading
    from jausml.live.machine.findings import Finding


@click.command("doctor")
@click.argument("models", nargs=-1, metavar="[MODEL]...")
@interface_option()
@port_option(text="UDP and TCP port of JAUS.")
@multicast_group_option()
@peer_option()
@format_option("Text for people, or one JSON object.")
@reading_options
@quiet_option("Leave out what is in order.")
def command(
    models: tuple[str, ...],
    interface: str,
    port: int,
    multicast_group: str,
    peers: tuple[str, ...],
    output_format: str,
    reading: Reading,
    quiet: bool,
) -> None:
    """Show what this machine lacks to run bridges and components, and how to fix it.

    Checks Python, optional programs, ROS 2 and its settings, the network interface, multicast, the
    port of JAUS, and node managers. With a MODEL or a folder of models, by default those of the
    project of the current folder, also checks the message packages that they use, your own among
    them. With --peer, also asks these components for their services and their state, and says what
    they do otherwise than the standard has it, and what jausml does instead. Changes nothing; sends
    one datagram from this host to itself, and a few questions to each peer.

    Exit status: 0 nothing is wrong (notes and warnings may be shown), 1 something cannot work, 2
    usage, 3 internal error.
    """
    from jausml.live.machine import network, programs, python, ros
    from jausml.live.machine.findings import Verdict

    settings = transport_settings(interface, port, multicast_group)
    paths = models or project_files()
    packages = _packages(paths, reading) if paths else {}
    findings = [
        *python.python_checks(),
        *programs.program_checks(),
        *ros.ros_checks(packages),
        *network.network_checks(settings),
    ]
    if peers:
        findings += _peers(interface, port, multicast_group, peers)
    shown = [finding for finding in findings if not (quiet and finding.verdict is Verdict.OK)]
    if shown or output_format == "json":
        click.echo(_as_json(shown) if output_format == "json" else _as_text(shown))
    if any(finding.verdict is Verdict.ERROR for finding in findings):
        raise click.exceptions.Exit(PROBLEMS)


def _peers(interface: str, port: int, group: str, peers: Sequence[str]) -> list[Finding]:
    """Returns the findings about components that are asked."""
    from jausml.cli.live.network import identified_network, network_from
    from jausml.cli.shared.models import open_catalogue
    from jausml.live.machine.findings import Finding, Verdict
    from jausml.live.peers.operator import check_peers

    network = network_from(None, interface, port, group, peers)
    try:
        with identified_network(network) as ours:
            verdicts = check_peers(ours, open_catalogue(()))
    except OSError as error:
        text = f"nobody can be asked: {error.strerror or error}"
        return [Finding("peers", "network", Verdict.ERROR, text)]
    return [Finding("peers", name, Verdict(verdict), text) for name, verdict, text in verdicts]


def _packages(paths: Sequence[str], reading: Reading) -> dict[str, bool]:
    """Returns the packages of messages that models use, and whether each is the user's own."""
    from jausml.language.metamodel.classes import ros

    model = read(paths, reading).model
    used = model.instances(ros.InterfacePackage)
    ownership_by_package = {
        str(package.name): not model.is_library(package) for package in used if package.name
    }
    return dict(sorted(ownership_by_package.items()))


def _as_text(findings: Sequence[Finding]) -> str:
    lines: list[str] = []
    topic = ""
    for finding in findings:
        if finding.topic != topic:
            topic = finding.topic
            lines += ["", topic] if lines else [topic]
        verdict = finding.verdict.value
        lines.append(f"  {painted(verdict, f'{verdict:<8}')} {finding.name}: {finding.text}")
        if finding.cure:
            lines.append(f"  {'':<8} -> {finding.cure}")
    verdicts = [finding.verdict.value for finding in findings]
    numbers = ((verdicts.count(word), word) for word in ("error", "warning", "note"))
    return "\n".join([*lines, "", counted(*numbers)])


def _as_json(findings: Sequence[Finding]) -> str:
    checks = [{**asdict(finding), "verdict": finding.verdict.value} for finding in findings]
    return json.dumps({"checks": checks}, indent=2, ensure_ascii=False)
