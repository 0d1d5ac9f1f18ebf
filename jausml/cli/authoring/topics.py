"""Shared parts of the verbs that make bridges of topics: words, choices, and what was chosen."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from shlex import quote
from typing import TypeAlias

import click

from jausml.authoring.proposals.bridging import is_served
from jausml.authoring.proposals.mapping.opens import STOPS, stops_by_zeros
from jausml.authoring.proposals.topic_names import is_emergency_stop
from jausml.authoring.proposals.topics import (
    Crossing,
    TopicEnd,
    clashes,
    crossings,
    feeds,
    joins_of,
    unanswered_queries,
    why_not,
)
from jausml.cli.authoring.new import Choosing
from jausml.cli.shared.terminal import can_ask, choose, remark
from jausml.language.interfaces.definitions import is_package_name, is_type_name
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.names import name_of
from jausml.language.model.values import suggest
from jausml.language.project import library
from jausml.language.semantics.connections.hold_reasons import is_reason
from jausml.language.semantics.connections.topics import topic_fault
from jausml.language.semantics.jaus.commands import is_emergency
from jausml.language.semantics.names import snake_case
from jausml.language.semantics.paths.ros_paths import ros_name

LeftOut: TypeAlias = "Callable[[TopicEnd, str, str], None]"
"""Takes a topic without a way, why it has none, and the command that comes next."""

_FEW = 4


def holds_of(words: Sequence[str], topics: Sequence[TopicEnd]) -> dict[str, str]:
    """Returns the reasons of a person why last commands may stand, by topic."""
    known = {topic.name for topic in topics}
    reasons_by_topic: dict[str, str] = {}
    for word in words:
        name, _, reason = word.partition("=")
        if name not in known:
            raise click.UsageError(f"--hold {word!r}: there is no topic {name!r} here")
        if not is_reason(reason):
            raise click.UsageError(
                f"--hold {name}: say what you know about the receiver that makes it safe"
            )
        reasons_by_topic[name] = reason.strip()
    return reasons_by_topic


def _with_joints(topics: Sequence[TopicEnd], words: Sequence[str]) -> list[TopicEnd]:
    """Returns topics with the names of joints that a person states, `TOPIC=NAME,...`."""
    stated: dict[str, tuple[str, ...]] = {}
    for word in words:
        name, _, names = word.partition("=")
        if name not in [topic.name for topic in topics]:
            raise click.UsageError(f"--joints {word!r}: there is no topic {name!r} here")
        stated[name] = joints_of(names)
    return [replace(topic, names=stated.get(topic.name, topic.names)) for topic in topics]


def joints_of(text: str) -> tuple[str, ...]:
    """Returns the names in `shoulder,elbow,wrist`."""
    names = tuple(word.strip() for word in text.split(","))
    if not all(names) or len({*names}) < len(names):
        raise click.UsageError(f"--joints {text!r} should be like shoulder,elbow,wrist")
    return names


def topics_of(words: Sequence[str]) -> list[TopicEnd]:
    """Returns the topics that words such as `odom:nav_msgs/Odometry` name."""
    topics_by_name: dict[str, TopicEnd] = {}
    for word in words:
        name, _, rest = word.partition(":")
        kind, _, maps = rest.partition(":")
        package, _, message = kind.replace("/msg/", "/", 1).partition("/")
        if not (is_package_name(package) and is_type_name(message)):
            full = _full(kind)
            example = f"{name}:{full}" if full else "cmd_vel:geometry_msgs/Twist"
            raise click.UsageError(f"{word!r} is no TOPIC:TYPE[:MAP,...] such as {example}")
        if fault := topic_fault(name):
            raise click.UsageError(f"{word!r}: the name of the topic {fault}")
        if name in topics_by_name:
            raise click.UsageError(f"the topic {name} is there twice: name its maps behind a colon")
        chosen = tuple(map_name for map_name in maps.split(",") if map_name)
        topics_by_name[name] = TopicEnd(name, f"{package}/{message}", maps=chosen)
    return list(topics_by_name.values())


def _full(message: str) -> str:
    """Returns the type with its package of which ready maps have a message name; empty for none."""
    maps = library().instances(bridge.AttributeMap)
    known = {ros_name(carried.type) for carried in maps if carried.type is not None}
    return min((name for name in known if name.partition("/")[2] == message), default="")


def chosen_crossings(
    topics: Sequence[TopicEnd],
    maps: Sequence[bridge.AttributeMap],
    choosing: Choosing,
    left_out: LeftOut | None = None,
) -> list[Crossing]:
    """Returns the ways that are taken; asks where a topic has several.

    `left_out`: what tells of a topic without a way, and why; without it, that is an error.
    """
    side, yes = choosing.side, choosing.yes
    reasons = holds_of(choosing.holds, topics)
    topics = _with_joints(topics, choosing.joints)
    offered = {end.name: crossings(end, maps, side) for end in topics}
    joins = [join for offer in offered.values() for way in offer for join in _fed_joins(way)]
    waiting = {end.name for end in topics if any(feeds(end, join) for join in joins)}
    taken_crossings: list[Crossing] = []
    for topic in topics:
        if candidates := offered[topic.name]:
            taken_crossings += _taken(topic, candidates, maps, choosing)
        elif topic.name not in waiting:
            _without(topic, maps, side, left_out)
    named = [crossing for crossing in taken_crossings if crossing.names]
    _check_stated("--joints", choosing.joints, named, "no map of it knows joints by names")
    without_stop = [crossing for crossing in taken_crossings if crossing.has_no_stop]
    _check_stated("--hold", choosing.holds, without_stop, "no map of it needs a reason")
    taken_crossings = [
        crossing for crossing in taken_crossings if not _lacks_names(crossing, left_out)
    ]
    for crossing, first in clashes(taken_crossings):
        taken_crossings.remove(crossing)
        _clash(crossing, first)
    map_ = {
        topic_name for joins in joined(taken_crossings, topics) for topic_name in joins.values()
    }
    for topic in topics:
        is_left = topic.name in waiting and not offered[topic.name] and topic.name not in map_
        if is_left and left_out is not None:
            left_out(topic, f"no topic that is carried has a join for {topic.name}", "")
    if not taken_crossings and left_out is None:
        raise click.UsageError("no topic is left that a bridge could carry")
    return [_decided(crossing, reasons, yes=yes) for crossing in taken_crossings]


def _clash(crossing: Crossing, first: Crossing) -> None:
    """Shows that a way is left out, since another topic has its message."""
    name, message = crossing.topic.name, name_of(crossing.offer.message)
    does = "is commanded by" if crossing.offer.to_ros else "makes"
    remark(
        f"left out: {name}: {first.topic.name} {does} {message} already, and a component has one; "
        f"a bridge of its own, or {name}:{crossing.topic.type}:MAP, carries it"
    )


def _check_stated(
    option: str, words: Sequence[str], concerned: Sequence[Crossing], reason: str
) -> None:
    """Refuses statements on topics for which they have no meaning, `TOPIC=...`."""
    names = {crossing.topic.name for crossing in concerned}
    for name in (word.partition("=")[0] for word in words):
        if name not in names:
            raise click.UsageError(f"{option} {name}: {reason}")


def _lacks_names(crossing: Crossing, left_out: LeftOut | None) -> bool:
    """Tells whether a way needs unknown names of joints, and shows that."""
    if not crossing.lacks_names:
        return False
    name = crossing.topic.name
    reason = f"{name_of(crossing.map)} knows the joints of {name} by their names"
    if left_out is None:
        raise click.UsageError(f"{reason}: state those of the robot by --joints {name}=NAME,NAME")
    command = f"jausml new connection {name}:{crossing.topic.type} --joints {name}=NAME,NAME"
    left_out(crossing.topic, f"{reason}, and nobody publishes them", command)
    return True


def joined(chosen: Sequence[Crossing], topics: Sequence[TopicEnd]) -> list[dict[str, str]]:
    """Returns for each way which topics feed the joins of its map, by the names of the joins."""
    fed: set[str] = set()
    return [joins_of(crossing, topics, fed) for crossing in chosen]


def _decided(crossing: Crossing, reasons: Mapping[str, str], *, yes: bool) -> Crossing:
    """Returns a way with a person's reason why its last command may stand, if there is one."""
    if not crossing.has_no_stop:
        return crossing
    reason = reasons.get(crossing.topic.name, "")
    if not reason and not yes and can_ask():
        reason = _ask_reason(crossing)
    return replace(crossing, hold_reason=reason)


def _ask_reason(crossing: Crossing) -> str:
    message, topic = name_of(crossing.offer.message), crossing.topic.name
    if is_emergency(crossing.offer.message):
        question = f"What may release the emergency stop ({message} of {topic})? (empty: later)"
    else:
        text = f"Nothing stops what {message} of {topic} sets in motion when its source is lost."
        click.echo(text, err=True)
        question = "Why is it safe that the last command stands then? (empty: decide later)"
    reason = str(click.prompt(question, "", show_default=False, err=True)).strip()
    return reason if is_reason(reason) else ""


def _fed_joins(way: Crossing) -> Sequence[bridge.Join]:
    """Returns the joins of a way that topics feed."""
    return () if way.offer.to_ros else way.map.joins


def _without(
    topic: TopicEnd, maps: Sequence[bridge.AttributeMap], side: str, left_out: LeftOut | None
) -> None:
    for wanted in topic.maps:
        if refusal := why_not(wanted, topic, maps, side):
            raise click.UsageError(f"{topic.name}: {refusal}")
    frames = (quote(f'{path}="{name}"') for path, name in topic.own_frames.items())
    stated = "".join(f" --to-ros {frame}" for frame in frames)
    command = f"jausml new map {snake_case(topic.name)} MESSAGE {topic.type}{stated}"
    named = crossings(replace(topic, maps=tuple(map(name_of, maps))), maps, side)
    is_stop = is_emergency_stop(topic.name)
    if candidates := [
        crossing for crossing in named if is_served(crossing.offer.service) is is_stop
    ]:
        _unsaid(topic, candidates, command, left_out)
        return
    known = {ros_name(carried.type) for carried in maps if carried.type is not None}
    hint = suggest(topic.type, known - {topic.type}) if topic.type not in known else ""
    reason = f"no ready map carries {topic.type} of {topic.name} for a {side}"
    reason += "".join(f"; {note}" for note in _parts_carried(topic.type, maps))
    if left_out is None:
        ask = f"jausml list maps tells which there are; {command} begins one"
        raise click.UsageError(f"{reason}; {hint or ask}")
    left_out(topic, reason, command)


def _parts_carried(kind: str, maps: Sequence[bridge.AttributeMap]) -> Iterator[str]:
    """Yields which elements of a type ready maps carry, one on a topic."""
    whole = next(
        (
            message_type
            for message_type in library().instances(ros.MessageType)
            if ros_name(message_type) == kind
        ),
        None,
    )
    for field in whole.fields if whole is not None else ():
        if isinstance(field, ros.MessageField) and field.arrayKind.name != "single":
            inner = ros_name(field.messageType)
            carried = (
                attribute_map
                for attribute_map in maps
                if attribute_map.type and attribute_map.toJaus
            )
            names = [
                name_of(attribute_map)
                for attribute_map in carried
                if ros_name(attribute_map.type) == inner
            ]
            if names:
                yield (
                    f"its {field.name} are {inner}, and of a topic of one of them "
                    f"{', '.join(names[:_FEW])} makes a report"
                )


def _unsaid(
    topic: TopicEnd, candidates: Sequence[Crossing], command: str, left_out: LeftOut | None
) -> None:
    """Shows that the type of a topic has no meaning alone, and what a person may state."""
    reason = f"nothing in the name {topic.name} says what its {topic.type} means"
    if is_emergency_stop(topic.name):
        reason = f"{topic.name} is an emergency stop: a person states what presses and releases it"
    names = list(dict.fromkeys(name_of(crossing.map) for crossing in candidates))
    options = ", ".join(names[:_FEW])
    if len(names) > _FEW:
        options += f" and {len(names) - _FEW} more"
    hint = f"{topic.name}:{topic.type}:MAP takes one of {options}"
    if left_out is None:
        remark(f"left out: {reason}; {hint}")
    else:
        left_out(topic, f"{reason}; {hint}", command)


def _taken(
    topic: TopicEnd,
    candidates: Sequence[Crossing],
    maps: Sequence[bridge.AttributeMap],
    choosing: Choosing,
) -> list[Crossing]:
    yes = choosing.yes
    if topic.maps:
        by_name = {name_of(crossing.map): crossing for crossing in reversed(candidates)}
        missing = [map_name for map_name in topic.maps if map_name not in by_name]
        if missing:
            names = ", ".join(sorted(by_name))
            reason = why_not(missing[0], topic, maps, choosing.side)
            reason = reason or f"no ready map {missing[0]!r}; there are {names}"
            raise click.UsageError(f"{topic.name}: {reason}")
        return [by_name[map_name] for map_name in topic.maps]
    if yes or len(candidates) == 1:
        if others := ", ".join(name_of(crossing.map) for crossing in candidates[1:]):
            map_ = name_of(candidates[0].map)
            remark(
                f"{topic.name}: {map_} is used; {others} would fit too (name them after a colon)"
            )
        return [candidates[0]]
    options = _options(candidates)
    if not can_ask():
        listed = "".join(f"\n  {topic.name}:{topic.type}:{option}" for option in options)
        text = f"{topic.name} fits several maps: name one, or take the first by --yes{listed}"
        raise click.UsageError(text)
    return [
        candidates[index]
        for index in choose(f"{topic.name} ({topic.type}) fits several maps:", options)
    ]


def _options(candidates: Sequence[Crossing]) -> list[str]:
    """Returns the choices; ways with the same description are told apart by their maps."""
    descriptions = []
    for way in candidates:
        does = way.says().partition(": ")[2]
        is_alone = sum(crossing.says().partition(": ")[2] == does for crossing in candidates) == 1
        about = " ".join(str(way.map.documentation or "").split())
        descriptions.append(
            way.says() if is_alone or not about else f"{name_of(way.map)}: {does}. {about}"
        )
    return descriptions


def show_chosen(chosen: Sequence[Crossing], topics: Sequence[TopicEnd]) -> None:
    """Shows the connection of each topic, and which facts of the vehicle a map has assumed."""
    for crossing, joins in zip(chosen, joined(chosen, topics), strict=True):
        click.echo(_crossing_line(crossing))
        for join, topic in joins.items():
            used = name_of(crossing.map)
            click.echo(f"{topic}: ROS -> JAUS, {used}: read as {join} with {crossing.topic.name}")
    for quantity, used in _assumed(chosen):
        unit = f" {quantity.units}" if quantity.units else ""
        said = f"{name_of(quantity)} of {used} is {quantity.value:g}{unit}"
        click.echo(f"{said} unless a quantity of the bridge states that of the vehicle")


def show_undecided(chosen: Sequence[Crossing]) -> None:
    """Shows last the decisions that a person has to make before anything is generated."""
    names = [crossing for crossing in chosen if crossing.has_no_stop and not crossing.hold_reason]
    if not names:
        return
    click.echo("\nYou have to decide what happens when the source of a command is lost:", err=True)
    for name in names:
        message = name_of(name.offer.message)
        stands = f"nothing stops what {message} sets in motion"
        if is_emergency(name.offer.message):
            stands = f"nobody says what releases the emergency stop ({message}); JML500 asks for it"
        click.echo(f"  {name.topic.name}: {stands}", err=True)
        if stops_by_zeros(name.map, [name.offer.to_ros]):
            stop, used = STOPS[name.offer.to_ros], name_of(name.map)
            advice = (
                f"its numbers are all rates: if zeros stop it, give map {used} a {stop} of zeros"
            )
            click.echo(f"    {advice}", err=True)
    click.echo(
        "  validate reports JML451 until each has a stop (a safeValue, or one in its map), or a\n"
        "  reason why the last command may stand (onSilence: hold and holdReason, or --hold).\n"
        "  No tool knows what is safe for what receives them.",
        err=True,
    )


def show_unanswered(chosen: Sequence[Crossing]) -> None:
    """Shows the queries of the services of a new bridge that have no answer."""
    for service, queries in unanswered_queries(chosen).items():
        remark(f"{service}: no connection answers {', '.join(queries)}")


def _assumed(chosen: Sequence[Crossing]) -> list[tuple[bridge.Quantity, str]]:
    """Returns the numbers of a vehicle that maps assume, each with the name of a map."""
    quantities_by_name: dict[str, tuple[bridge.Quantity, str]] = {}
    for crossing in chosen:
        for quantity in crossing.map.quantities:
            quantities_by_name.setdefault(name_of(quantity), (quantity, name_of(crossing.map)))
    return list(quantities_by_name.values())


def _crossing_line(crossing: Crossing) -> str:
    arrow = "JAUS -> ROS" if crossing.offer.to_ros else "ROS -> JAUS"
    reason = crossing.hold_reason
    stands = "the last command stands when its source is lost"
    if is_emergency(crossing.offer.message):
        stands = "what releases it"
    held = f"; {stands}: {reason}" if reason else ""
    own = f"; joints {', '.join(crossing.names)}" if crossing.names else ""
    own += "".join(f"; the frame {old} is {new}" for old, new in crossing.frames.items())
    return f"{crossing.topic.name}: {arrow}, {crossing.says()}{own}{held}"
