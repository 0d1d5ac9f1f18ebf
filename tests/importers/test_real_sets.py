"""Service sets as other tools ship them are imported whole and agree with the library."""

import re
from pathlib import Path

import emf_check
import pytest
from jsidl_support import ROOT
from needs import SHARED

from jausml.language.importers.jsidl import import_jsidl
from jausml.language.importers.jsidl.scopes import pick_version
from jausml.language.importers.jsidl.services import services_by_urn
from jausml.language.model import read_models
from jausml.language.model.comparison import ON_THE_WIRE, Policy, compare
from jausml.language.model.project import Reading
from jausml.language.model.xmi.writer import write_model
from jausml.language.project import library
from jausml.language.semantics.jaus.core_services import newest_services
from jausml.language.validation.engine import check_project

JSIDL = SHARED / "jsidl"
SETS = ["urn.jaus.jss.core-v1.1", "urn.jaus.jss.mobility"]
NAMES = [*SETS, ""]
IDS = [*SETS, "both"]
pytestmark = [pytest.mark.beside(f"jsidl/{name}") for name in SETS]

# The library describes another edition of AS6009 than these files: in it Speed of a vector has no
# presence bit, the list drivers inherit the ListManager of AS5710A and take waypoints, and
# AccelerationStateSensor is of version 0.6.
OTHER_EDITION = {
    "GlobalVectorDriver/SetGlobalVector/GlobalVectorRec/Speed: optional: True / False",
    "GlobalVectorDriver/ReportGlobalVector/GlobalVectorRec/Speed: optional: True / False",
    "LocalVectorDriver/SetLocalVector/LocalVectorRec/Speed: optional: True / False",
    "LocalVectorDriver/ReportLocalVector/LocalVectorRec/Speed: optional: True / False",
    *(
        f"{kind}WaypointListDriver: {difference}"
        for kind in ("Global", "Local")
        for difference in (
            "inherits: urn:jaus:jss:mobility:ListManager 1.0 / urn:jaus:jss:core:ListManager 1.1",
            f"inputs: nothing / Set{kind}Waypoint",
        )
    ),
    # The library has them where their drivers are: the source gives them to the lists alone.
    *(
        f"{kind}PathSegmentDriver: inputs: nothing / Set{kind}PathSegment"
        for kind in ("Global", "Local")
    ),
    "AccelerationStateSensor: version: 1.0 / 0.6",
    *(
        "AccelerationStateSensor/ReportAccelerationState/ReportAccelerationStateRec"
        f"/{field}: optional: True / False"
        for field in (
            *(f"Acceleration_{axis}" for axis in "XYZ"),
            *(f"{angle}Acceleration" for angle in ("Roll", "Pitch", "Yaw")),
        )
    ),
}


def files(name):
    return sorted((JSIDL / name).rglob("*.xml"))


@pytest.mark.parametrize("name", SETS)
def test_no_difference_from_the_library(name):
    result = import_jsidl(files(name))
    assert not result.has_errors
    shipped = services_by_urn(library("jaus"))
    found = set()
    for service in (imported_service for root in result.sets for imported_service in root.services):
        versions = shipped[service.urn]
        theirs = versions[pick_version(service.version, versions)]
        found |= {str(e) for e in compare(service, theirs, result.model.metamodels, ON_THE_WIRE)}
    assert found == (OTHER_EDITION if "mobility" in name else set())


def test_what_events_of_transport_carry_is_that_of_the_library():
    """In the library too the code generator of the JAUS Tool Set finds the types of parameters."""
    result = import_jsidl(files("urn.jaus.jss.core-v1.1"))
    (imported,) = (e for root in result.sets for e in root.services if e.name == "Transport")
    ours = newest_services()[imported.urn]
    names = ["Send", "BroadcastLocal", "BroadcastGlobal", "Receive"]
    assert [event.name for event in ours.events] == names
    policy = Policy(ignored=frozenset({"documentation"}))
    for one, other in zip(imported.events, ours.events, strict=True):
        assert compare(one, other, result.model.metamodels, policy) == []


def write_set(name, place):
    """Imports service sets and writes them; returns the file."""
    result = import_jsidl(files(name))
    path = place / "set.xmi"
    write_model(result.sets, result.model, path)
    return path


@pytest.mark.parametrize("name", NAMES, ids=IDS)
def test_the_model_is_sound(name, tmp_path):
    path = write_set(name, tmp_path)
    assert read_models([path], project_root=tmp_path).diagnostics == []
    assert not check_project([path], Reading(project_root=tmp_path)).has_errors


@pytest.mark.needs("emf")
@pytest.mark.parametrize("name", NAMES, ids=IDS)
def test_eclipse_finds_nothing(name, tmp_path):
    library = f"{ROOT / 'models' / 'library'}/"
    mapped = ("--map", "http://www.jausml.org/library/", library)
    jaus = ROOT / "metamodels" / "jaus.ecore"
    done = emf_check.ask(*mapped, jaus, write_set(name, tmp_path))
    assert (done.returncode, done.stdout) == (0, "")


def test_all_behaviour_is_expressed():
    texts = [path.read_text(encoding="utf-8") for path in files("")]
    result = import_jsidl(files(""))
    made = [m for root in result.sets for service in root.services for m in service.machines]
    assert len(made) == sum(len(re.findall(r"<state_machine\s", text)) for text in texts)
    pending = [state for machine in made for state in machine.states]
    transitions = 0
    while pending:
        state = pending.pop()
        pending += state.states
        transitions += len(state.transitions) + len(state.defaults)
    # What the runtime takes by itself is no transition, and told so.
    taken = [
        finding for finding in result.diagnostics if "of the runtime, not by" in finding.message
    ]
    written = sum(len(re.findall(r"<transition\s", text)) for text in texts)
    assert (transitions + len(taken), len(taken)) == (written, 12)
    assert {diagnostic.rule for diagnostic in result.diagnostics} == {"JML624", "JML626", "JML629"}
    assert Path(result.diagnostics[0].location.path).exists()
