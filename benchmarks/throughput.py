"""How many messages a second come through without loss, and what processor time each one takes.

Stamped points, one way or both ways at once, in steps that grow until a variant loses more than a
thousandth. The ends are this process and one other, which take what comes between what they send.
"""

from __future__ import annotations

import random
from functools import partial
from typing import TYPE_CHECKING, Any

from counterpart import Counterpart
from ends import drained, paced
from figures import rounded
from names import COMPILED, FLOOR, GENERATED, GENERIC, RELAY, TYPED
from processes import Children
from samples import sample
from systems import Measured, generate
from variants import Route, reached

if TYPE_CHECKING:
    from pathlib import Path

    from scale import Scale

STEPS = (1000, 4000, 6000, 8000, 10000, 15000)
WAYS = ("up", "down", "both")
MOST_LOST = 0.001
_SECONDS = 1.0
_TRIES = 2
"""A step counts as lost when it was lost twice: a busy machine may stall once."""


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures each way of each variant.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        For each way and variant the `steps` with their loss and processor time for each message,
        and the `rate` of the greatest one without loss.
    """
    system = generate(folder, {"one_point": Measured(("point",))})
    system.compile()
    message = sample(system.model, "point")
    steps = scale.cases(STEPS, 4)
    seconds = max(_SECONDS * scale.factor, 0.3)
    with Children(system.environment(), folder / "processes.log") as children:
        variants = scale.cases((COMPILED, RELAY, FLOOR, GENERATED, TYPED, GENERIC), 6)
        routes = [Route(each, system, "one_point", message) for each in variants]
        publish, take = ([each.topic(way) for each in routes] for way in ("down", "up"))
        topics = ["--publish", *publish, "--take", *take]
        other = Counterpart(children, folder, message, *topics)
        for route in routes:
            route.start(children, folder)
        routes = reached(routes, partial(_reach, other))
        found = {way: _climb(routes, other, way, steps, seconds) for way in WAYS}
        for route in routes:
            route.close()
        other.begin("end")
    return found


def _reach(other: Counterpart, route: Route) -> None:
    def up() -> bool:
        route.send()
        return other.ask("take", seconds=0)["taken"] > 0

    def down() -> bool:
        other.ask("publish", topic=route.topic("down"), rate=100, seconds=0.05)
        return route.end.discard() > 0

    route.until(up)
    route.until(down)


def _climb(
    routes: list[Route], other: Counterpart, way: str, steps: list[int], seconds: float
) -> dict[str, Any]:
    """Goes up the steps, the variants by turns, until each one has lost too much."""
    found: dict[str, Any] = {each.variant: {"rate": 0, "steps": {}} for each in routes}
    left = list(routes)
    for rate in steps:
        random.shuffle(left)
        for route in tuple(left):
            step = _best_step(route, other, way, rate, seconds)
            found[route.variant]["steps"][str(rate)] = step
            if step["lost"] > MOST_LOST:
                left.remove(route)
            else:
                found[route.variant]["rate"] = rate
    told = ", ".join(f"{variant} {figures['rate']}/s" for variant, figures in found.items())
    print(f"  {way}: {told}", flush=True)
    return found


def _best_step(
    route: Route, other: Counterpart, way: str, rate: int, seconds: float
) -> dict[str, float]:
    """Tries a step until it is without loss."""
    tries = []
    for _ in range(_TRIES):
        tries.append(_step(route, other, way, rate, seconds))
        if tries[-1]["lost"] <= MOST_LOST:
            break
    return min(tries, key=lambda each: each["lost"])


def _step(
    route: Route, other: Counterpart, way: str, rate: int, seconds: float
) -> dict[str, float]:
    """Sends at a rate; returns what share was lost, and the processor time for each message."""
    route.end.discard()
    before = route.processor_time()
    if way == "up":
        other.begin("take", seconds=seconds)
    else:
        other.begin("publish", topic=route.topic("down"), rate=rate, seconds=seconds)
    sent = 0
    if way == "down":
        came = drained(route.end.discard, seconds)
    else:
        sent, came = paced(route.send, route.end.discard, rate, seconds)
    answer = other.answer()
    arrived = answer["taken"]
    if way == "both":
        arrived += other.ask("take", seconds=0)["taken"]
    came += drained(route.end.discard, 0)
    used = route.processor_time() - before
    if way != "up":
        sent, arrived = sent + answer["sent"], arrived + came
    return {
        "lost": round(max(1 - arrived / sent, 0.0), 5),
        "processor_us": rounded(1e6 * used / max(arrived, 1)),
        "sent": sent,
    }
