"""One run reports all problems: a broken feature hides neither the others nor other elements."""

import pytest

from jausml.language.validation.engine import check_project

HEAD = (
    '<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
    ' xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:ros="http://www.jausml.org/ros/1.0"'
    ' xmlns:bridge="http://www.jausml.org/bridge/1.0"'
    ' xmlns:system="http://www.jausml.org/system/1.0" name="robot">'
)
TYPE = '<type href="http://www.jausml.org/library/ros/geometry_msgs.xmi#{}"/>'


def rules_of(tmp_path, text, name="model.xmi"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return [diagnostic.rule for diagnostic in check_project([path]).diagnostics]


def system(*elements):
    return f"{HEAD}{''.join(elements)}</system:System>"


CASES = {
    "an unknown attribute": (
        '<components name="arm" address="1.1.1" authority="999" bogus="1"/>',
        ["JML103", "JML303"],
    ),
    "an unknown attribute that may be one": (
        '<components name="arm" address="1.1.1" authority="999" eventTimeouts="1"/>',
        ["JML103", "JML303"],
    ),
    "a type that is not found": (
        f'<nodes name="n"><subscriptions topic="a//b" name="s">{TYPE.format("Twst")}'
        "</subscriptions></nodes>",
        ["JML204", "JML401"],
    ),
    "an unknown literal": (
        '<bridges name="b" address="1.1.1" frequency="10"><bridgeConnections name="c" '
        'direction="x" silenceTimeout="-3"/></bridges>',
        ["JML105", "JML108", "JML108", "JML425"],
    ),
    "a wrong value": (
        '<components name="arm" address="0.1.1" authority="high" controlTimeout="256"/>',
        ["JML106", "JML301", "JML303"],
    ),
    "a missing reference": (
        '<components name="arm" address="1.1.1"><connections name="c" silenceTimeout="-1" '
        'exchange="periodic" rate="2000"><provider href="#nobody"/></connections></components>',
        ["JML108", "JML202", "JML303", "JML306"],
    ),
    "a duplicate id": (
        '<components xmi:id="a" name="arm" address="1.1.1"/>'
        '<components xmi:id="a" name="leg" address="1.1.1" authority="256"/>',
        ["JML201", "JML302", "JML303"],
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_one_problem_of_an_element_does_not_hide_another(case, tmp_path):
    element, expected = CASES[case]
    assert sorted(rules_of(tmp_path, system(element))) == expected


def test_text_too(tmp_path):
    text = "component arm {\n    address: 1.1.1\n    authority: 999\n    bogus: 1\n}\n"
    assert sorted(rules_of(tmp_path, text, "model.ros2jaus")) == ["JML103", "JML303"]


def test_a_model_of_many_problems_tells_all_of_them(tmp_path):
    expected = sorted(rule for _, rules in CASES.values() for rule in rules)
    # Names and addresses of the parts differ, so that they meet in one system without more ado.
    parts = []
    for number, (element, _) in enumerate(CASES.values()):
        part = element.replace("1.1.1", f"1.1.{number + 1}").replace('id="a"', f'id="a{number}"')
        for name in ("arm", "leg", "b", "n"):
            part = part.replace(f' name="{name}"', f' name="{name}_{number}"')
        parts.append(part)
    assert sorted(rules_of(tmp_path, system(*parts))) == expected
    assert len(expected) > 17
