"""Colours of pictures: those of Okabe and Ito, darkened or lightened until they can be read."""

from __future__ import annotations

from jausml.views.diagrams.graph import ADDED, CHANGED, REMOVED

SIDES = {
    "component": "jaus",
    "message": "jaus",
    "bridge": "bridge",
    "node": "ros",
    "type": "ros",
}
"""What kinds of boxes belong to; others have the colour of lines."""

_LIGHT = {
    "ground": "#FFFFFF",
    "body": "#FFFFFF",
    "ink": "#1B1B1B",
    "muted": "#6B6B6B",
    "line": "#6B6B6B",
    "frame": "#F5F5F5",
    "jaus": "#0072B2",
    "bridge": "#A8447F",
    "ros": "#00795A",
    "error": "#B34700",
    "warning": "#7A5300",
    "added": "#0072B2",
    "added_body": "#D6EBFA",
    "removed": "#B34700",
    "removed_body": "#FBE0CC",
    "changed": "#7A5300",
    "changed_body": "#FFF4BF",
}
_DARK = {
    "ground": "#1E1E1E",
    "body": "#262626",
    "ink": "#EEEEEE",
    "muted": "#A0A0A0",
    "line": "#A0A0A0",
    "frame": "#232323",
    "jaus": "#56B4E9",
    "bridge": "#E5A4C6",
    "ros": "#4CC9A0",
    "error": "#FF8A3D",
    "warning": "#F0C44C",
    "added": "#56B4E9",
    "added_body": "#123A52",
    "removed": "#FF8A3D",
    "removed_body": "#55290F",
    "changed": "#F0C44C",
    "changed_body": "#4A3F10",
}
STATES = (ADDED, REMOVED, CHANGED)
"""What parts may be where two states are compared: blue, orange and yellow can be told apart by
whoever sees red and green as one; signs and dashes say the same."""

_SHARED = (
    ".diagram{font-family:Helvetica,Arial,'Liberation Sans',sans-serif}"
    ".edge{fill:none;stroke-width:1.2}.control,.owns{stroke-dasharray:5 4}"
    ".bridge .body{stroke-width:3}.body{stroke-width:1.5}.frame rect{stroke-width:1}"
    ".doubled{fill:none;stroke-width:1.5}.rule{stroke-width:.6;fill:none}.behind{opacity:.85}"
)


def style(theme: str, *, compares: bool = False) -> str:
    """Returns the style sheet of a picture.

    `theme`: `light`, `dark`, or `auto` for that of whoever looks.
    """
    light, dark = (_rules(each) + (_compared(each) if compares else "") for each in (_LIGHT, _DARK))
    if theme == "auto":
        return f"{_SHARED}{light}@media(prefers-color-scheme:dark){{{dark}}}"
    return _SHARED + (dark if theme == "dark" else light)


def outline(kind: str, severity: str = "") -> str:
    """Returns the colour of the outline of a box, on light ground.

    `severity`: how grave what is wrong with it is, empty for nothing.
    """
    return _LIGHT["error"] if severity == "error" else _LIGHT[SIDES.get(kind, "line")]


def variables() -> str:
    """Returns the colours as properties for the style sheet of a page, as whoever looks has it."""
    light, dark = (
        "".join(f"--{name}:{value};" for name, value in colours.items())
        for colours in (_LIGHT, _DARK)
    )
    return (
        f":root{{color-scheme:light dark;{light}}}"
        f"@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"
    )


def _rules(colours: dict[str, str]) -> str:
    rules = [
        ".ground,.behind{fill:%(ground)s}.body{fill:%(body)s;stroke:%(line)s}",
        "text{fill:%(ink)s}.muted{fill:%(muted)s}.mark{fill:%(ink)s}.flow{fill:%(ink)s}",
        ".frame rect{fill:%(frame)s;stroke:%(muted)s}.rule{stroke:%(muted)s}",
        ".edge{stroke:%(line)s}.head{fill:%(line)s}",
        *(f".box.{kind} .body{{stroke:%({side})s}}" for kind, side in SIDES.items()),
        ".edge.message,.edge.to_ros{stroke:%(jaus)s}.edge.topic,.edge.to_jaus{stroke:%(ros)s}",
        ".edge.call{stroke:%(bridge)s}",
        ".doubled,.edge.error{stroke:%(error)s}text.error{fill:%(error)s}",
        "text.warning,text.info{fill:%(warning)s}",
    ]
    return "".join(rules) % colours


def _compared(colours: dict[str, str]) -> str:
    rules = [".removed .body,.frame.removed rect,.edge.removed{stroke-dasharray:6 4}"]
    for each in STATES:
        rules += [
            f".box.{each} .body,.frame.{each} rect{{fill:%({each}_body)s}}",
            f".edge.{each}{{stroke:%({each})s;stroke-width:2.6}}",
            f"text.{each}{{fill:%({each})s;font-weight:bold}}",
        ]
    return "".join(rules) % colours
