"""Letters typed in an editor: what the language server does for each, in processor time.

The text becomes another one by the change as the editor tells it, its tree is made, and its syntax
errors are known. What is asked after that letter is measured by itself.
"""

from __future__ import annotations

import statistics
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from figures import rounded

from jausml.authoring.editor.completion import complete
from jausml.authoring.editor.hover import hover
from jausml.authoring.editor.places import Columns, Place
from jausml.authoring.editor.workbench import Workbench
from jausml.language.text.reading.pieces import roughly_parsed

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from scale import Scale

SIZES = (8_000, 90_000, 870_000)
"""Characters of the texts."""

_LETTERS = 9
_TYPED = {"a letter": "1", "a new line": "\n", "an open bracket": "{", "an open comment": "/*"}
_CONNECTION = """
    // What the sensor tells.
    connection c{n} {{
      map: velocity_state
      peers: sensor
      rate: {n}
      topic /twist_{n} {{ qos: {{ depth: 5 }} }}
    }}
"""


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures all.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        For each text the median of the processor time, in milliseconds: for each of what is typed,
        and for completions and hovers behind that.
    """
    found = {}
    for size in scale.cases(SIZES, 1):
        found[f"{size:,} characters"] = _measured(_text(size), scale, folder / "typed.ros2jaus")
        print(f"  {size:,}: {found[f'{size:,} characters']}", flush=True)
    return found


def _text(size: int) -> str:
    bridges: list[str] = []
    at = 0
    while sum(map(len, bridges)) < size:
        connections = "".join(_CONNECTION.format(n=n) for n in range(1, 9))
        head = f"\n  component sensor_{at} {{\n    address: 9.{at % 250 + 1}.1\n  }}\n"
        bridges.append(f"{head}\n  bridge front_{at} {{\n{connections}  }}\n")
        at += 1
    return f"import mappings.velocity_state_sensor\n\nsystem grown {{{''.join(bridges)}}}\n"


def _measured(text: str, scale: Scale, path: Path) -> dict[str, float]:
    bench = Workbench()
    columns = Columns(text)
    line = text.count("\n", 0, text.index("rate: 5", len(text) // 2))
    place = Place(line, len("      peers: s"))
    at = (line, len("      rate: 5"))

    def type_(new: str, number: int) -> None:
        edited = columns.edited(at, at, f"{number}{new}")
        bench.texts[path] = edited.text
        roughly_parsed(edited.text)

    type_("", 0)
    complete(bench, path, place)
    hover(bench, path, place)  # they load what is asked
    found: dict[str, list[float]] = {}
    for name, new in _TYPED.items():
        for number in range(scale.count(_LETTERS, 1)):
            found.setdefault(name, []).append(_milliseconds(partial(type_, new, number)))
            if name == "a letter":
                asked = {"a completion": complete, "a hover": hover}
                for question, ask in asked.items():
                    took = _milliseconds(partial(ask, bench, path, place))
                    found.setdefault(question, []).append(took)
    return {name: rounded(statistics.median(each)) for name, each in found.items()}


def _milliseconds(run: Callable[[], Any]) -> float:
    started = time.process_time()
    run()
    return 1e3 * (time.process_time() - started)
