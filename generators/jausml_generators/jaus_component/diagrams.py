"""State diagrams in Mermaid's language, which code hosts and editors draw."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.attributes.guards import AllOf, AnyOf, Condition, Guard, Negation, parse_guard
from jausml.language.semantics.inherited_machines import CORE_STATES, Machine, event_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import jaus

_INDENT = "    "


def diagram(machine: Machine) -> str:
    """Returns the lines of a diagram: the modelled states, each inside what encloses it.

    A transition that only acts leads from its state to itself and says so.
    """
    keys = {path: f"s{number}" for number, path in enumerate(_shown(machine), 1)}
    inside: dict[str, list[str]] = {}
    for path in keys:
        inside.setdefault(path.rpartition(".")[0], []).append(path)
    lines = ["stateDiagram-v2", *_states(machine, keys, inside, "", 1)]
    for path, node in machine.nodes.items():
        for state in node.elements:
            for transition in [*state.transitions, *state.defaults]:
                lines.append(_INDENT + _arrow(machine, keys, path, transition))
    return "\n".join(lines)


def guard_text(guard: Guard) -> str:
    """Returns a guard as text again, without what stands before names and in parentheses."""
    if isinstance(guard, Condition):
        return guard.name
    if isinstance(guard, Negation):
        inner = guard_text(guard.operand)
        return f"!{inner}" if isinstance(guard.operand, Condition) else f"!({inner})"
    sign = " && " if isinstance(guard, AllOf) else " || "
    return sign.join(
        f"({guard_text(each)})" if isinstance(each, AnyOf) else guard_text(each)
        for each in guard.operands
    )


def _shown(machine: Machine) -> list[str]:
    """Returns the modelled states and the targets of their transitions, enclosing ones too."""
    paths = dict.fromkeys(machine.nodes)
    for path, node in machine.nodes.items():
        for state in node.elements:
            for transition in [*state.transitions, *state.defaults]:
                target = machine.resolve(path, transition.target) if transition.target else None
                names = (target or "").split(".")
                paths.update(
                    dict.fromkeys(".".join(names[:end]) for end in range(1, len(names) + 1))
                )
    paths.pop("", None)
    return list(paths)


def _states(
    machine: Machine, keys: dict[str, str], inside: dict[str, list[str]], outer: str, depth: int
) -> Iterator[str]:
    margin = _INDENT * depth
    initial = machine.initial(outer)
    # Which core state is entered first is not for this machine to say.
    if initial in keys and not (machine.extends_core and initial in CORE_STATES):
        yield f"{margin}[*] --> {keys[initial]}"
    for path in inside[outer]:
        name = path.rpartition(".")[2]
        if path in inside:
            yield f'{margin}state "{name}" as {keys[path]} {{'
            yield from _states(machine, keys, inside, path, depth + 1)
            yield f"{margin}}}"
        else:
            yield f'{margin}state "{name}" as {keys[path]}'


def _arrow(machine: Machine, keys: dict[str, str], path: str, transition: jaus.Transition) -> str:
    message = transition.message
    label = message.name if message is not None else event_name(transition.event) or "anything else"
    guard = parse_guard(transition.guard)
    if guard is not None:
        label += f" [{guard_text(guard)}]"
    if transition.actions:
        label += " / " + ", ".join(a.name.rpartition(".")[2] for a in transition.actions)
    kind = transition.kind.name
    label += {"internal": " (stays)", "push": " (push)", "pop": " (pop)"}.get(kind, "")
    target = machine.resolve(path, transition.target) if transition.target else path
    return f"{keys[path]} --> {keys[target or path]} : {label}"
