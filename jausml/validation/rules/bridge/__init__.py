"""Rules about bridges, connections and attribute maps."""

from jausml.validation.rules.bridge import (
    connections,
    conversions,
    coverage,
    deployment,
    frames,
    freshness,
    joins,
    lists,
    maps,
    out_of_range,
    ranges,
    round_trips,
    tables,
    units,
    vectors,
)

MODULES = (
    connections,
    conversions,
    coverage,
    deployment,
    frames,
    freshness,
    joins,
    lists,
    maps,
    out_of_range,
    ranges,
    round_trips,
    tables,
    units,
    vectors,
)
