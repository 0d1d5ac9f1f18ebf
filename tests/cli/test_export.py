"""`jausml export jsidl`: which services it writes, what it says, and what it leaves alone."""

import json
from pathlib import Path

import pytest

GUARDS = ("models/examples/winch",)
EXAMPLES = Path(__file__).parents[2] / "models" / "examples"
WINCH = EXAMPLES / "winch" / "service.xmi"
NAME = "urn.jausml.examples.Winch-1.0.xml"


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_service_becomes_a_file(jausml, here):
    done = jausml("export", "jsidl", WINCH, "-o", "out/jsidl")
    assert done.exit_code == 0, done.output
    assert names(here / "out/jsidl") == [NAME]
    assert "out/jsidl: 1 service, 1 written" in done.stderr
    assert "service.xmi:62:13: warning: JML632" in done.stdout
    done = jausml("export", "jsidl", WINCH, "-o", "out/jsidl", "--quiet", "--format", "json")
    assert done.stderr == ""
    rules = {diagnostic["rule"] for diagnostic in json.loads(done.stdout)["diagnostics"]}
    assert rules == {"JML631", "JML632"}


@pytest.mark.usefixtures("here")
def test_what_it_writes_can_be_imported_and_is_valid(jausml):
    jausml("export", "jsidl", WINCH, "-o", "out")
    assert jausml("import", "jsidl", "out", "-o", "winch.xmi").exit_code == 0
    done = jausml("validate", "winch.xmi")
    assert done.exit_code == 0, done.output


def test_inherited_services_come_along_when_they_are_asked_for(jausml, here):
    done = jausml("export", "jsidl", WINCH, "-o", "out", "--with-inherited")
    assert done.exit_code == 0, done.output
    core = ("AccessControl", "Events", "Management", "Transport")
    assert names(here / "out") == [
        *(f"urn.jaus.jss.core.{service_name}-1.1.xml" for service_name in core),
        NAME,
    ]


def test_of_a_system_the_services_that_its_components_provide_are_written(jausml, here):
    done = jausml("export", "jsidl", EXAMPLES / "catvehicle" / "catvehicle.ros2jaus", "-o", "out")
    assert done.exit_code == 0, done.output
    assert "urn.jaus.jss.mobility.PrimitiveDriver-1.0.xml" in names(here / "out")


def test_a_file_that_differs_is_left_alone(jausml, refused, here):
    jausml("export", "jsidl", WINCH, "-o", "out")
    (here / "out" / NAME).write_text("precious", encoding="utf-8")
    refused("--force", "export", "jsidl", WINCH, "-o", "out")
    assert (here / "out" / NAME).read_text(encoding="utf-8") == "precious"
    assert "1 written" in jausml("export", "jsidl", WINCH, "-o", "out", "--force").stderr
    assert "1 unchanged" in jausml("export", "jsidl", WINCH, "-o", "out").stderr


def test_what_is_no_jsidl_is_not_written(jausml, here):
    text = WINCH.read_text(encoding="utf-8")
    text = text.replace("../../library/", "http://www.jausml.org/library/")
    start, end = text.index("  <services"), text.index("</jaus:ServiceSet>")
    twin = text[start:end].replace("Winch.", "Twin.").replace('"Winch"', '"Twin"')
    (here / "model.xmi").write_text(text[:end] + twin + text[end:], encoding="utf-8")
    done = jausml("export", "jsidl", "model.xmi", "-o", "out")
    assert done.exit_code == 1
    assert "JML633 Twin is no JSIDL: service urn:jausml:examples:Winch" in done.stdout
    assert "nothing written" in done.stderr
    assert not (here / "out").exists()


def test_a_model_without_services_is_said(refused, here):
    (here / "ros.xmi").write_text(
        '<?xml version="1.0" encoding="UTF-8"?>\n<jaus:ServiceSet xmi:version="2.0"'
        ' xmlns:xmi="http://www.omg.org/XMI" xmlns:jaus="http://www.jausml.org/jaus/1.0"'
        ' name="nothing"/>\n',
        encoding="utf-8",
    )
    refused("ros.xmi has no services", "export", "jsidl", "ros.xmi", "-o", "out")


def test_a_folder_that_cannot_be_made_is_said(refused, here):
    (here / "out").write_text("a file", encoding="utf-8")
    refused("cannot write out", "export", "jsidl", WINCH, "-o", "out")
