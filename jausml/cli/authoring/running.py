"""The running graph of ROS, as lines and as topics of a bridge, and commands for all else."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import click

from jausml.authoring.proposals.elements import (
    AnswerError,
    Scope,
    action_type_of,
    plain_type,
    service_type_of,
    type_of,
)
from jausml.authoring.proposals.goals import ways_for, why_none
from jausml.authoring.proposals.topics import (
    TopicEnd,
    frame_role,
    is_worth_reading,
    robots_in,
    says,
    within,
)
from jausml.cli.authoring.topics import LeftOut
from jausml.cli.shared.files import EnvironmentFault, ending_at
from jausml.language.model.values import suggest
from jausml.live.ros.node import RosFault
from jausml.live.ros.running import RosEndpoint, Running, RunningCall, RunningTopic, what_runs

_FRAME_PATHS = ("header.frame_id", "child_frame_id")
_ODOMETRY = "nav_msgs/msg/Odometry"

_LONGEST_VALUE = 60  # characters of a parameter that are shown


def what_runs_here(seconds: float) -> Running:
    """Returns the running system, after it has listed all of it."""
    with ending_at(RosFault):
        running = what_runs(seconds, is_worth_reading)
    graph = running.graph
    if not graph:
        raise EnvironmentFault(f"no topic, service or action runs here (looked for {seconds:g} s)")
    for topic in graph.topics:
        click.echo(_line(topic))
    for call in (*graph.services, *graph.actions):
        click.echo(_call_line(call))
    for line in (*_said_lines(running), *_parameter_lines(running)):
        click.echo(line)
    return running


def _said_lines(running: Running) -> Iterator[str]:
    """Yields which joints and frames the messages name."""
    for topic, names in sorted(running.joints.items()):
        yield f"{topic} names the joints {', '.join(names)}"
    for topic, (frame, child) in sorted(running.frames.items()):
        inner = f"{' and ' if frame else ''}the child frame {child}" if child else ""
        yield f"{topic} names {f'the frame {frame}' if frame else ''}{inner}"
    for topic in running.silent:
        yield f"{topic} was silent: what its messages name is not known"


def _parameter_lines(running: Running) -> Iterator[str]:
    """Yields the parameters with a meaning for a model, and the meaning."""
    for node, values in sorted(running.parameters.items()):
        for name, value in sorted(values.items()):
            if meaning := says(name, value):
                shown = "" if len(str(value)) > _LONGEST_VALUE else f" {value}"
                yield f"{node} has {name}{shown}: {meaning}"
    for node in running.unread:
        yield f"{node} does not tell its parameters"


def _frames(running: Running) -> dict[str, str]:
    """Returns the robot's frames by those of REP 105, as far as they are known.

    Odometry tells what is; parameters tell what somebody wants.
    """
    published: dict[str, set[str]] = {}
    for topic in running.graph.topics:
        if topic.types == (_ODOMETRY,) and topic.name in running.frames:
            for role, name in zip(("odom", "base_link"), running.frames[topic.name], strict=True):
                published.setdefault(role, set()).update({name} - {""})
    stated: dict[str, set[str]] = {}
    for values in running.parameters.values():
        for parameter, value in values.items():
            if (role := frame_role(parameter)) and isinstance(value, str):
                stated.setdefault(role, set()).update({value} - {""})
    frames_by_role = {}
    for role in (*published, *stated):
        names = published.get(role) or stated.get(role, set())
        if len(names) == 1 and names != {role}:
            frames_by_role[role] = next(iter(names))
    return frames_by_role


def topics_in(running: Running, words: Sequence[str], namespace: str = "") -> list[TopicEnd]:
    """Returns the topics of a graph that a bridge can carry.

    `words`: those that are meant, as `TOPIC` or `TOPIC:MAP,...`; all without any.
    """
    frames = _frames(running)
    known = {
        topic.name: replace(_end(topic, running, namespace), frames=frames)
        for topic in running.graph.topics
        if len(topic.types) == 1
    }
    if not words:
        return list(known.values())
    return [_named(word, known) for word in words]


def of_one_robot(topics: Sequence[TopicEnd], namespace: str | None) -> list[TopicEnd]:
    """Returns the topics of a namespace, or all where they look like those of one robot.

    Of several robots, one bridge would command all at once: then somebody has to say which.
    """
    if namespace is None and (robots := robots_in(topics)):
        namespace_options = "".join(f"\n  --namespace {robot or '/'}" for robot in robots)
        raise click.UsageError(
            "several namespaces have topics of the same names, as several robots have; give each "
            f"robot a bridge of its own:{namespace_options}"
        )
    if namespace is None:
        return list(topics)
    own_topics = within(topics, namespace)
    if not own_topics:
        raise click.UsageError(f"no topic runs in the namespace {namespace!r}")
    return own_topics


def _named(word: str, known: dict[str, TopicEnd]) -> TopicEnd:
    name, _, maps = word.partition(":")
    topic = known.get(name if name.startswith("/") else f"/{name}")
    if topic is None:
        hint = suggest(f"/{name.strip('/')}", known)
        raise click.UsageError(f"no topic {name!r} of one type runs; {hint}".rstrip("; "))
    return replace(topic, maps=tuple(map_name for map_name in maps.split(",") if map_name))


def _line(topic: RunningTopic) -> str:
    kinds = " and ".join(topic.types)
    ends = (
        _nodes(endpoint.node for endpoint in endpoints)
        for endpoints in (topic.publishers, topic.subscriptions)
    )
    return f"{topic.name}  {kinds}  from {' to '.join(ends)}"


def _call_line(call: RunningCall) -> str:
    kinds = " and ".join(call.types)
    used = f", called by {_nodes(call.clients)}" if call.clients else ""
    return f"{call.name}  {kinds}  served by {_nodes(call.servers)}{used}"


def _nodes(names: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(names)) or "nobody"


def _relative(name: str, namespace: str) -> str:
    """Returns a name relative to where the bridge is: so another namespace moves it too."""
    return name.removeprefix(f"/{namespace.strip('/')}/" if namespace.strip("/") else "/")


def _end(topic: RunningTopic, running: Running, namespace: str) -> TopicEnd:
    """Returns a topic with the direction and quality of service that its ends leave."""
    is_one_way = bool(topic.publishers) is not bool(topic.subscriptions)
    return TopicEnd(
        _relative(topic.name, namespace),
        plain_type(topic.types[0]),
        bool(topic.subscriptions) if is_one_way else None,
        heard=_heard(topic.publishers),
        published=_published(topic.subscriptions),
        names=_joints(topic, running),
        own_frames={
            path: name
            for path, name in zip(_FRAME_PATHS, running.frames.get(topic.name, ()), strict=False)
            if name
        },
    )


def _joints(topic: RunningTopic, running: Running) -> tuple[str, ...]:
    """Returns the joints of a topic: in its messages, else in those of its nodes."""
    if topic.name in running.joints:
        return running.joints[topic.name]
    own = {subscription.node for subscription in topic.subscriptions}
    by_own = {
        running.joints[running_topic.name]
        for running_topic in running.graph.topics
        if running_topic.name in running.joints
        and own & {end.node for end in running_topic.publishers}
    }
    candidates = by_own or set(running.joints.values())
    return next(iter(candidates)) if len(candidates) == 1 else ()


def _heard(publishers: Sequence[RosEndpoint]) -> dict[str, str] | None:
    """Returns the quality by which all of some publishers are heard: the least that they offer."""
    if not publishers:
        return None
    sure = all(publisher.reliability == "reliable" for publisher in publishers)
    # What was published before is repeated to reliable subscriptions alone.
    kept = sure and all(publisher.durability == "transient_local" for publisher in publishers)
    policies = {"reliability": "reliable" if sure else "best_effort"}
    return {**policies, "durability": "transient_local"} if kept else policies


def _published(subscriptions: Sequence[RosEndpoint]) -> dict[str, str] | None:
    """Returns the quality for all of some subscriptions: as much as the most demanding asks for."""
    if not subscriptions:
        return None
    kept = any(subscription.durability == "transient_local" for subscription in subscriptions)
    return {"reliability": "reliable", **({"durability": "transient_local"} if kept else {})}


def show_left(running: Running, scope: Scope, namespace: str) -> None:
    """Says of all that is no topic of a bridge why, and which command comes next.

    `namespace`: that of the bridge; what is called beyond it is of others.
    """
    space = f"/{namespace.strip('/')}/".replace("//", "/")
    for topic in running.graph.topics:
        if len(topic.types) > 1:
            _left(f"{topic.name} has several types, a fault of its nodes")
    for kind, next_of, calls in (
        ("service", _service, running.graph.services),
        ("action", _action, running.graph.actions),
    ):
        for call in calls:
            if not call.name.startswith(space):
                continue
            if len(call.types) > 1:
                _left(f"{kind} {call.name} has several types, a fault of its nodes")
                continue
            side = "" if call.servers else " --side operator"
            _left(*next_of(scope, call.name.removeprefix(space), call.types[0], side))


def left_topic(scope: Scope) -> LeftOut:
    """Returns the function that shows why a topic is left out, and which command comes next."""

    def tell(topic: TopicEnd, reason: str, command: str) -> None:
        try:
            type_of(scope, topic.type)
        except AnswerError:
            command = _imported(topic.type, command)
        _left(reason, command)

    return tell


def _left(reason: str, command: str = "") -> None:
    click.echo(f"left out: {reason}{f'; next: {command}' if command else ''}", err=True)


def _service(scope: Scope, name: str, kind: str, side: str) -> tuple[str, str]:
    """Returns why a service is left out, and what comes next."""
    used = plain_type(kind)
    command = f"jausml new service-connection {name}:{used} MESSAGE{side}"
    reason = f"service {name}: no type says which JAUS message asks"
    try:
        service_type_of(scope, used)
    except AnswerError:
        return f"service {name}: no model has {used}", _imported(used, command)
    return reason, command


def _action(scope: Scope, name: str, kind: str, side: str) -> tuple[str, str]:
    """Returns why an action is left out, and what comes next."""
    used = plain_type(kind)
    command = f"jausml new action-connection {name}:{used}{side}"
    try:
        action_type = action_type_of(scope, used)
    except AnswerError:
        return f"action {name}: no model has {used}", _imported(used, command)
    candidates = ways_for(scope, action_type, to_ros=not side)
    if not candidates:
        return f"action {name}: {why_none(action_type, to_ros=not side)}", ""
    return f"action {name}: list drivers can have its goals ({candidates[0].says()})", command


def _imported(used: str, command: str) -> str:
    """Returns the commands for what no model has the type of."""
    return f"jausml import ros {used.partition('/')[0]}, then {command}"
