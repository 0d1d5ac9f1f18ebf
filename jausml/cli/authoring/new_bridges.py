"""`jausml new bridge` and `new connection`: topics that a bridge carries, named or running."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.places import model_option, place_for, report, stopping
from jausml.cli.authoring.topics import (
    chosen_crossings,
    show_chosen,
    show_unanswered,
    show_undecided,
    topic_options,
    topics_of,
)
from jausml.cli.shared.files import EnvironmentFault
from jausml.cli.shared.options import FiniteRange

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from jausml.authoring.proposals.topics import TopicEnd
    from jausml.live.ros import RosEndpoint, RunningTopic


def graph_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options of looking at what runs to a verb."""
    from_graph = click.option(
        "--from-graph",
        is_flag=True,
        help="Use the topics that exist in ROS now: all, or those named by arguments "
        "TOPIC[:MAP,...].",
    )
    seconds = click.option(
        "--for",
        "seconds",
        type=FiniteRange(0.1, 600),
        default=10.0,
        show_default=True,
        metavar="SECONDS",
        help="Longest time to look at the running system.",
    )
    return from_graph(seconds(command))


def topics_that_run(words: Sequence[str], seconds: float, namespace: str = "") -> list[TopicEnd]:
    """Returns topics that run now, after it has listed all of them.

    Args:
        words: Those that are meant, as `TOPIC` or `TOPIC:MAP,...`; all without any.
    """
    from jausml.live.ros import RosFault, running_topics

    try:
        running = running_topics(seconds)
    except RosFault as error:
        raise EnvironmentFault(str(error)) from error
    if not running:
        raise EnvironmentFault(f"no topic runs here (looked for {seconds:g} s)")
    for each in running:
        click.echo(_line(each))
    known = {each.name: _end(each, namespace) for each in running if len(each.types) == 1}
    if not words:
        return list(known.values())
    return [_named(word, known) for word in words]


def _named(word: str, known: dict[str, TopicEnd]) -> TopicEnd:
    from jausml.language.model.values import suggest

    name, _, maps = word.partition(":")
    found = known.get(name if name.startswith("/") else f"/{name}")
    if found is None:
        hint = suggest(f"/{name.strip('/')}", known)
        raise click.UsageError(f"no topic {name!a} of one type runs; {hint}".rstrip("; "))
    return replace(found, maps=tuple(each for each in maps.split(",") if each))


def _line(topic: RunningTopic) -> str:
    def nodes(ends: Sequence[RosEndpoint]) -> str:
        return ", ".join(dict.fromkeys(each.node for each in ends)) or "nobody"

    kinds = " and ".join(topic.types)
    return f"{topic.name}  {kinds}  from {nodes(topic.publishers)} to {nodes(topic.subscriptions)}"


def _end(topic: RunningTopic, namespace: str) -> TopicEnd:
    """Returns a topic with the direction and quality of service that its ends leave."""
    from jausml.authoring.proposals.topics import TopicEnd

    is_one_way = bool(topic.publishers) is not bool(topic.subscriptions)
    return TopicEnd(
        # Relative to where the bridge is: so another namespace moves it too.
        topic.name.removeprefix(f"/{namespace.strip('/')}/" if namespace.strip("/") else "/"),
        topic.types[0].replace("/msg/", "/", 1),
        bool(topic.subscriptions) if is_one_way else None,
        heard=_heard(topic.publishers),
        published=_published(topic.subscriptions),
    )


def _heard(publishers: Sequence[RosEndpoint]) -> dict[str, str] | None:
    """Returns what hears all of some publishers: no more than the least of them offers."""
    if not publishers:
        return None
    sure = all(each.reliability == "reliable" for each in publishers)
    # What was published before is repeated to reliable subscriptions alone.
    kept = sure and all(each.durability == "transient_local" for each in publishers)
    found = {"reliability": "reliable" if sure else "best_effort"}
    return {**found, "durability": "transient_local"} if kept else found


def _published(subscriptions: Sequence[RosEndpoint]) -> dict[str, str] | None:
    """Returns what all of some subscriptions get: as much as the most demanding asks for."""
    if not subscriptions:
        return None
    kept = any(each.durability == "transient_local" for each in subscriptions)
    return {"reliability": "reliable", **({"durability": "transient_local"} if kept else {})}


@click.command("bridge")
@click.argument("name", metavar="NAME")
@click.argument("words", metavar="[TOPIC:TYPE[:MAP,...]]...", nargs=-1)
@click.option(
    "--topics", "by_topics", is_flag=True, help="Read the arguments as topics (the default)."
)
@graph_options
@click.option("--address", metavar="ID", help="JAUS id; by default, a free one.")
@topic_options
@model_option
def bridge(
    name: str,
    words: tuple[str, ...],
    by_topics: bool,
    from_graph: bool,
    seconds: float,
    address: str | None,
    side: str,
    yes: bool,
    holds: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add a bridge named NAME that carries ROS topics by ready maps.

    For each topic, proposes service, map, direction, exchange and quality of service. If several
    maps fit, asks which one to use; --yes takes the likeliest, and TOPIC:TYPE:MAP names one. A
    topic whose name does not suggest a command becomes a report, which moves nothing.

    With --from-graph, lists the running ROS topics, and takes types, directions and quality of
    service from them. Topics without a ready map are left out, with a message.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_bridge, ready_maps

    if by_topics and from_graph:
        raise click.UsageError("--topics and --from-graph exclude each other")
    if not words and not from_graph:
        raise click.UsageError("name topics, such as cmd_vel:geometry_msgs/Twist")
    with stopping():
        place = place_for(model)
        topics = topics_that_run(words, seconds) if from_graph else topics_of(words)
        chosen = chosen_crossings(
            topics, ready_maps(place), side=side, yes=yes, holds=holds, all_needed=bool(words)
        )
        files = add_bridge(place, name, chosen, topics, address or "")
    show_chosen(chosen, topics)
    show_unanswered(chosen)
    report(place, files)
    show_undecided(chosen)


@click.command("connection")
@click.argument("words", metavar="TOPIC:TYPE[:MAP,...]...", nargs=-1, required=True)
@click.option(
    "--bridge", metavar="NAME", help="Bridge that gets the connections, if there are several."
)
@graph_options
@topic_options
@model_option
def connection(
    words: tuple[str, ...],
    bridge: str | None,
    from_graph: bool,
    seconds: float,
    side: str,
    yes: bool,
    holds: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add connections to a bridge, which carry further ROS topics by ready maps.

    Proposes a connection for each topic, as `jausml new bridge` does, and adds the services that
    the bridge needs for it.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_connections, namespace_of, ready_maps

    with stopping():
        place = place_for(model)
        space = namespace_of(place, bridge or "")
        topics = topics_that_run(words, seconds, space) if from_graph else topics_of(words)
        chosen = chosen_crossings(topics, ready_maps(place), side=side, yes=yes, holds=holds)
        files = add_connections(place, bridge or "", chosen, topics)
    show_chosen(chosen, topics)
    report(place, files)
    show_undecided(chosen)
