"""Parameters of a node of rclpy, and the quality of service of its topics."""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ListParametersResult,
    ParameterDescriptor,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMessage
from rclpy.duration import Duration
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter as RclpyParameter
from rclpy.parameter import get_parameter_value
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from ...base.counters import LOGGER
from ..ends.topics import EndpointHealth, Parameter, ParameterError, Qos, nearest


class LazyParameters(Node):
    """A node that declares a parameter when it is first used; before, it is `offered` by name.

    Each connection has eight parameters, of which most are never used, and each declaration of
    rclpy makes four messages and publishes one.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        self.offered: dict[str, Callable[[], object]] = {}  # rclpy asks while it makes the node
        super().__init__(*arguments, **options)
        self.add_pre_set_parameters_callback(self._declare_set)

    def has_parameter(self, name: str) -> bool:
        """Returns whether there is a parameter, which rclpy checks before each access."""
        self._declare(name)
        return bool(super().has_parameter(name))

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Returns the type, limits and text of a parameter."""
        self._declare(name)
        return super().describe_parameter(name)

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Any]:
        """Returns parameters by their names behind a prefix."""
        self._declare(*self.offered)
        parameters: dict[str, Any] = super().get_parameters_by_prefix(prefix)
        return parameters

    def list_parameters(self, prefixes: list[str], depth: int) -> ListParametersResult:
        """Returns the names of parameters; declares them only for a prefix or depth."""
        if prefixes or depth:
            self._declare(*self.offered)
            return super().list_parameters(prefixes, depth)
        listing = super().list_parameters(prefixes, depth)
        names = list(self.offered)
        owners = (name.rpartition(".")[0] for name in names if "." in name)
        listing.names = [*listing.names, *names]
        listing.prefixes = list(dict.fromkeys([*listing.prefixes, *owners]))
        return listing

    def _declare_set(self, parameters: list[Any]) -> list[Any]:
        """Declares parameters that are to be set; returns them in their types: 10.0 for 10."""
        self._declare(*(parameter.name for parameter in parameters))
        return [self._as_declared(parameter) for parameter in parameters]

    def _as_declared(self, parameter: Any) -> Any:
        double = RclpyParameter.Type.DOUBLE
        is_integer = parameter.type_ == RclpyParameter.Type.INTEGER
        if (
            is_integer
            and self.has_parameter(parameter.name)
            and self.get_parameter(parameter.name).type_ == double
        ):
            return RclpyParameter(parameter.name, double, float(parameter.value))
        return parameter

    def _declare(self, *names: str) -> None:
        for name in names:
            if name in self.offered:
                self.offered.pop(name)()


class NodeParameters:
    """The parameters of one node, and their values from command line and files."""

    def __init__(self, node: Any, line: Sequence[str] = ()) -> None:
        """Follows changes of the parameters of a node with a command line."""
        self.overrides = {**_overrides(node), **_retyped(node, line)}
        self._node = node
        self._checks: dict[str, Callable[[Any], object]] = {}
        self._callbacks: dict[str, Callable[[Any], None]] = {}
        self._present: set[str] = set()
        self._declared: set[str] = set()
        self._errors: list[str] = []
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._apply)

    def declare(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Returns the value of a parameter; declares it now only if its value is overridden.

        After `release`, that is its present value. For a value that is not allowed, the default is
        returned, and `check` will raise.

        Args:
            changed: Called with each later value on the thread of the executor; without it the
                parameter is read-only.

        Raises:
            ParameterError: Another parameter has the same name.
        """
        name = parameter.name
        if name in self._present:
            raise ParameterError(f"two parameters have the name {name}")
        self._present.add(name)
        if parameter.check is not None:
            self._checks[name] = parameter.check
        if changed is not None:
            self._callbacks[name] = changed
        if name in self._declared:
            return self._node.get_parameter(name).value
        override = self.overrides.get(name)
        try:
            value = parameter.converted(parameter.default if override is None else override.value)
        except ValueError as error:
            self._errors.append(str(error))
            return parameter.default
        declare = partial(self._declare, parameter, value, is_fixed=changed is None)
        if override is None:
            self._node.offered[name] = declare
            return value
        return declare()

    def check(self) -> None:
        """Raises ParameterError with a line for each value that is not allowed, if any."""
        if self._errors:
            raise ParameterError("\n".join(self._errors))

    def release(self) -> None:
        """Follows no parameter any more, until it is declared again."""
        self._present.clear()
        self._callbacks.clear()
        self._errors.clear()

    def _declare(self, parameter: Parameter, value: Any, *, is_fixed: bool) -> Any:
        descriptor = _descriptor(parameter, is_fixed=is_fixed)
        with as_parameter_error():
            self._node.declare_parameter(parameter.name, value, descriptor, ignore_override=True)
        self._declared.add(parameter.name)
        return value

    def _check(self, parameters: Sequence[Any]) -> SetParametersResult:
        for parameter in parameters:
            try:
                self._checks.get(parameter.name, bool)(parameter.value)
            except ValueError as error:
                return SetParametersResult(successful=False, reason=f"{parameter.name}: {error}")
        return SetParametersResult(successful=True)

    def _apply(self, parameters: Sequence[Any]) -> None:
        for parameter in parameters:
            # A declaration is no change.
            if parameter.name in self._declared and parameter.name in self._callbacks:
                self._callbacks[parameter.name](parameter.value)


def warn_of_unknown(node: Any, possible: Iterable[str] = ()) -> None:
    """Warns of overrides of parameters that the node does not have, such as misspelt ones.

    Args:
        possible: Names of parameters that the node would declare if they were overridden.
    """
    unknown = [name for name in _overrides(node) if not node.has_parameter(name)]
    known = [*node.list_parameters([], 0).names, *possible] if unknown else []
    for name in unknown:
        similar = nearest(name, known)
        hint = f"; did you mean {similar}?" if similar else ""
        LOGGER.warning("%s has no parameter %s%s", node.get_fully_qualified_name(), name, hint)


@contextmanager
def as_parameter_error(about: str = "") -> Iterator[None]:
    """Raises ParameterError, with one line of text, for errors of ROS in names and values."""
    try:
        yield
    except (ParameterException, NameValidationException, RuntimeError) as error:
        raise ParameterError(about + " ".join(str(error).split())) from error


def _overrides(node: Any) -> Mapping[str, Any]:
    # rclpy has no public access to the values from command line and files.
    overrides: Mapping[str, Any] = node._parameter_overrides  # noqa: SLF001
    return overrides


def _retyped(node: Any, line: Sequence[str]) -> dict[str, Any]:
    """Returns parameters of the command line to which a file gives another type.

    ROS keeps only one of several types, which may be that of the file.
    """
    overrides = {}
    if "--params-file" in line:
        for option, text in pairwise(line):
            path, _, value = text.partition(":=")
            owner, _, name = path.rpartition(":")
            override = _overrides(node).get(name) if option in ("-p", "--param") else None
            if override and owner in ("", node.get_name(), node.get_fully_qualified_name()):
                stated = ParameterMessage(name=name, value=get_parameter_value(value))
                if stated.value.type != override.type_.value:
                    overrides[name] = RclpyParameter.from_parameter_msg(stated)
    return overrides


def _descriptor(parameter: Parameter, *, is_fixed: bool) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=parameter.description, read_only=is_fixed)
    if parameter.limits is None:
        return descriptor
    low, high = parameter.limits
    if isinstance(parameter.default, int):
        descriptor.integer_range = [IntegerRange(from_value=int(low), to_value=int(high))]
    else:
        descriptor.floating_point_range = [
            FloatingPointRange(from_value=float(low), to_value=float(high))
        ]
    return descriptor


OVERRIDABLE = ("reliability", "durability", "history", "depth")  # policies with parameters

# Least depth of a subscription that is not latched: enough for a stall of a tenth of a second at
# 1000 messages a second.
LEAST_DEPTH = 100

# Depth of a publisher with `keep_all`, as in Fast DDS, where each `publish` beyond it would block
# Python for a tenth of a second, so that one stalled reader would hold up all topics.
MAX_KEPT = 5000

_UNLIMITED = 2**63 - 1  # nanoseconds that ROS reports for no limit


def overridden(
    health: EndpointHealth, overrides: Container[str], parameter: Callable[[Parameter], Any]
) -> Qos:
    """Returns the quality of service of an endpoint, as changed by parameters.

    A parameter is only declared (by `parameter`) if it is in `overrides`: four for each endpoint
    would hide the important ones, and delay the start.
    """
    qos = health.qos
    for policy in OVERRIDABLE:
        name = health.parameter(policy)
        if name in overrides:
            text = f"{policy} of the {health.entity} of {health.topic}."
            value = parameter(Parameter(name, getattr(qos, policy), text))
            qos = replace(qos, **{policy: value})
    return qos


def deep_enough(qos: Qos) -> Qos:
    """Returns the quality of service of a subscription with at least `LEAST_DEPTH`.

    A latched one keeps its depth, which is the number of former messages that it requests.
    """
    if qos.durability == "volatile" and qos.history == "keep_last" and qos.depth < LEAST_DEPTH:
        return replace(qos, depth=LEAST_DEPTH)
    return qos


def never_waiting(qos: Qos) -> Qos:
    """Returns the quality of service of a publisher that drops old messages rather than block."""
    return replace(qos, history="keep_last", depth=MAX_KEPT) if qos.history == "keep_all" else qos


def profile_of(qos: Qos) -> QoSProfile:
    """Returns the rclpy profile of a QoS; raises RuntimeError for an unknown word."""
    profile = QoSProfile(
        reliability=_policy(ReliabilityPolicy, "reliability", qos.reliability),
        durability=_policy(DurabilityPolicy, "durability", qos.durability),
        history=_policy(HistoryPolicy, "history", qos.history),
        depth=qos.depth,
        liveliness=_policy(LivelinessPolicy, "liveliness", qos.liveliness),
    )
    if qos.deadline > 0:
        profile.deadline = Duration(seconds=qos.deadline)
    if qos.lifespan > 0:
        profile.lifespan = Duration(seconds=qos.lifespan)
    if qos.lease_duration > 0:
        profile.liveliness_lease_duration = Duration(seconds=qos.lease_duration)
    return profile


def qos_of(profile: QoSProfile) -> Qos:
    """Returns the QoS of a profile of another node, whose history and depth are unknown."""
    return Qos(
        reliability=profile.reliability.name.lower(),
        durability=profile.durability.name.lower(),
        deadline=_seconds(profile.deadline),
        lifespan=_seconds(profile.lifespan),
        liveliness=profile.liveliness.name.lower(),
        lease_duration=_seconds(profile.liveliness_lease_duration),
    )


def _policy(kind: Any, name: str, value: str) -> Any:
    try:
        return kind[value.upper()]
    except KeyError:
        raise RuntimeError(f"unexpected QoS override for policy {name}: {value}") from None


def _seconds(duration: Duration) -> float:
    count = duration.nanoseconds
    return count / 1e9 if 0 < count < _UNLIMITED else 0.0
