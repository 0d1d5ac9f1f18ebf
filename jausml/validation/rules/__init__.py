"""The rules, one module for each language and topic."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.validation.rules import (
    bridge_connections,
    bridge_conversions,
    bridge_coverage,
    bridge_frames,
    bridge_joins,
    bridge_lists,
    bridge_maps,
    bridge_out_of_range,
    bridge_ranges,
    bridge_round_trips,
    bridge_tables,
    bridge_units,
    bridge_vectors,
    jaus_components,
    jaus_machines,
    jaus_messages,
    jaus_services,
    names,
    ros,
    ros_installed,
    system,
)

if TYPE_CHECKING:
    from jausml.validation.rule import Rule


def all_rules() -> tuple[Rule, ...]:
    """Returns all rules, ordered by id."""
    rules = (
        *jaus_components.RULES,
        *jaus_services.RULES,
        *jaus_messages.RULES,
        *jaus_machines.RULES,
        *ros.RULES,
        *ros_installed.RULES,
        *bridge_maps.RULES,
        *bridge_frames.RULES,
        *bridge_tables.RULES,
        *bridge_joins.RULES,
        *bridge_lists.RULES,
        *bridge_vectors.RULES,
        *bridge_ranges.RULES,
        *bridge_round_trips.RULES,
        *bridge_units.RULES,
        *bridge_conversions.RULES,
        *bridge_coverage.RULES,
        *bridge_out_of_range.RULES,
        *bridge_connections.RULES,
        *names.RULES,
        *system.RULES,
    )
    return tuple(sorted(rules, key=lambda each: each.id))
