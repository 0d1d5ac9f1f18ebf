"""Parameters of a node of rclpy: declared, checked, followed."""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import NameValidationException, ParameterException

from ...base.counters import LOGGER
from ..ends.parameters import ParameterError, nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from ..ends.topics import Parameter


class NodeParameters:
    """The parameters of one node.

    Attributes:
        given: Names of those that the command line and parameter files give.
    """

    def __init__(self, node: Any) -> None:
        """Follows changes from now on."""
        self.given = frozenset(_given(node))
        self._node = node
        self._checks: dict[str, Callable[[Any], object]] = {}
        self._followers: dict[str, Callable[[Any], None]] = {}
        self._former: set[str] = set()
        self._declared: set[str] = set()
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._apply)

    def declare(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value.

        Args:
            changed: Takes each later value, on the thread of the executor; without it the parameter
                cannot change.

        Raises:
            ParameterError: The command line or a parameter file gives it a value of another type,
                or one that does not do.
        """
        if parameter.name in self._former:
            return self._again(parameter, changed)
        if parameter.check is not None:
            self._checks[parameter.name] = parameter.check
        with as_parameter_error():
            declared = self._node.declare_parameter(
                parameter.name, parameter.default, _descriptor(parameter, is_fixed=changed is None)
            )
        self._declared.add(parameter.name)
        if changed is not None:
            self.follow(parameter.name, changed)
        return declared.value

    def release(self) -> None:
        """Follows none any more; those that are declared again have their present values."""
        self._former = set(self._declared)
        for name in self._former:
            self._followers.pop(name, None)

    def _again(self, parameter: Parameter, changed: Callable[[Any], None] | None) -> Any:
        self._former.discard(parameter.name)
        if changed is not None:
            self.follow(parameter.name, changed)
        return self._node.get_parameter(parameter.name).value

    def follow(self, name: str, changed: Callable[[Any], None]) -> None:
        """Calls a function with each later value of a parameter that exists."""
        self._followers[name] = changed

    def _check(self, parameters: Sequence[Any]) -> SetParametersResult:
        for each in parameters:
            try:
                self._checks.get(each.name, bool)(each.value)
            except ValueError as error:
                return SetParametersResult(successful=False, reason=f"{each.name}: {error}")
        return SetParametersResult(successful=True)

    def _apply(self, parameters: Sequence[Any]) -> None:
        for each in parameters:
            if each.name in self._followers:
                self._followers[each.name](each.value)


def tell_unknown(node: Any, possible: Iterable[str] = ()) -> None:
    """Warns of parameters that nobody declared: they are misspelt, or of something else.

    Args:
        possible: Names of parameters that it would have declared, had they been given.
    """
    unknown = [name for name in _given(node) if not node.has_parameter(name)]
    known = [*node.list_parameters([], 0).names, *possible] if unknown else []
    for name in unknown:
        meant = nearest(name, known)
        hint = f"; did you mean {meant}?" if meant else ""
        LOGGER.warning("%s has no parameter %s%s", node.get_fully_qualified_name(), name, hint)


@contextmanager
def as_parameter_error(about: str = "") -> Iterator[None]:
    """Gives what ROS refuses of names, files and values one class, and one line of text."""
    try:
        yield
    except (ParameterException, NameValidationException, RuntimeError) as error:
        raise ParameterError(about + " ".join(str(error).split())) from error


def _given(node: Any) -> Iterable[str]:
    # rclpy keeps what command line and files say here, and has no other way to ask for it.
    names: Iterable[str] = node._parameter_overrides  # noqa: SLF001
    return names


def _descriptor(parameter: Parameter, *, is_fixed: bool) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=parameter.description, read_only=is_fixed)
    if parameter.limits is None:
        return descriptor
    low, high = parameter.limits
    if isinstance(parameter.default, int):
        descriptor.integer_range = [IntegerRange(from_value=int(low), to_value=int(high))]
    else:
        descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    return descriptor
