"""What is exported as JSIDL is imported as it was; what JSIDL cannot say is told."""

import re

import pytest
from for_each import for_each
from jsidl_support import ROOT, WINCH, winch
from lxml import etree
from needs import SHARED

from jausml.language.exporters.jsidl import export_jsidl
from jausml.language.exporters.jsidl.exporting import differences
from jausml.language.importers.jsidl import Source, import_jsidl, import_sources
from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.language.model.comparison import EXACT, Policy, compare

GUARDS = ("models/library/jaus", "models/examples")
OWN = ROOT / "models" / "examples" / "winch" / "service.xmi"
SETS = sorted((ROOT / "models" / "library" / "jaus").glob("*.xmi"))
CORE = ROOT / "models" / "library" / "jaus" / "core-1.1.xmi"
PAYLOAD = "MessagePayload"
# Machines are compared by what they do: the paths of the library become states in each other.
TOLD = Policy(ignored=frozenset({"frame", "moves", "jaus.Service.machines"}))
JSIDL = "{urn:jaus:jsidl:1.1}"
PARTS = (
    "description assumptions references declared_type_set message_set internal_events_set"
    " protocol_behavior"
)

DECLARED = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" name="light">
  <types xsi:type="jaus:Record" xmi:id="Colour" name="Colour">
    <fields xsi:type="jaus:TypeReference" name="Red" target="Share"/>
    <fields xsi:type="jaus:FixedField" name="Bearing" frame="localUp"/>
  </types>
  <types xsi:type="jaus:FixedField" xmi:id="Share" name="Share" units="percent"/>
  <services name="Lamp" urn="urn:example:light:Lamp">
    <inputs name="SetLamp" code="0xd100">
      <body xsi:type="jaus:Sequence" name="Seq" presenceVector="uint8">
        <fields xsi:type="jaus:TypeReference" name="Front" target="Colour" optional="true"
            documentation="The front lamp."/>
        <fields xsi:type="jaus:TypeReference" name="Back" target="Colour" frame="localDown"/>
        <fields xsi:type="jaus:Record" name="Rec">
          <fields xsi:type="jaus:VariableFormatField" name="Picture">
            <formats name="BMP" index="0" documentation="Without compression."/>
          </fields>
        </fields>
      </body>
    </inputs>
    <events name="Burnt"/>
    <machines name="Glow">
      <states name="On.Bright" initial="true">
        <transitions event="Burnt">
          <actions name="tell" sends="//@services.0/@outputs.0"/>
        </transitions>
      </states>
    </machines>
    <outputs name="ReportLamp" code="0xD101"/>
  </services>
</jaus:ServiceSet>
"""


def services(model):
    """Returns the services of the models that were given."""
    roots = [root for document in model.documents if document.is_input for root in document.roots]
    return [service for root in roots for service in root.services]


def again(result):
    """Imports what was exported; returns the import, and its services by URN and version."""
    imported = import_sources([Source(*item) for item in result.documents.items()])
    assert not imported.has_errors, [str(diagnostic) for diagnostic in imported.diagnostics]
    found = [service for root in imported.sets for service in root.services]
    return imported, {(service.urn, service.version): service for service in found}


def lost(model, exported, policy=EXACT):
    """Returns in what services differ from what their files say."""
    _, found = again(exported)
    pairs = [(service, found[service.urn, service.version]) for service in services(model)]
    return [str(loss) for pair in pairs for loss in compare(*pair, model.metamodels, policy)]


def is_the_same_again(exported):
    imported, found = again(exported)
    return export_jsidl(imported.model, list(found.values())).documents == exported.documents


@for_each("path", SETS, shards=4, slow=True, rest=0)
def test_a_set_of_the_library_comes_back(path):
    model = read_models([path]).model
    exported = export_jsidl(model, services(model))
    assert len(exported.documents) == len(services(model)) > 0
    assert lost(model, exported, TOLD) == []
    assert is_the_same_again(exported)
    # Each axis and each command that moves nothing is named where it stands.
    assert {diagnostic.rule for diagnostic in exported.diagnostics} == {"JML631"}
    told = [diagnostic.message for diagnostic in exported.diagnostics]
    for field in model.instances(jaus.Field, library=False):
        if field.frame.name != "unstated" and model.document_of(field).given:
            assert any("'frame'" in message and str(field.name) in message for message in told)


def test_services_have_files_of_their_own_whose_urns_differ_little(tmp_path):
    path = tmp_path / "set.xmi"
    urns = ("urn:example:a:Lamp", "urn:example:a/Lamp", "urn:example:A:lamp")
    lamps = (f'<services name="Lamp{n}" urn="{urn}"/>' for n, urn in enumerate(urns))
    path.write_text(DECLARED.partition("  <types")[0] + "".join(lamps) + "</jaus:ServiceSet>")
    model = read_models([path]).model
    exported = export_jsidl(model, services(model))
    assert len({name.lower() for name in exported.documents}) == len(urns)
    assert lost(model, exported) == []


def sets_of_others():
    """Returns the folders of the sets that other tools ship, at least one."""
    return sorted((SHARED / "jsidl").glob("urn.*"))


@pytest.mark.beside("jsidl")
@for_each("path", sets_of_others)
def test_a_set_of_other_tools_comes_back_with_its_machines(path):
    result = import_jsidl(sorted(path.rglob("*.xml")))
    model, made = result.model, [service for root in result.sets for service in root.services]
    assert sum(len(service.machines) for service in made) > 0
    exported = export_jsidl(model, made)
    assert [str(diagnostic) for diagnostic in exported.diagnostics] == []
    _, found = again(exported)
    pairs = [(service, found[service.urn, service.version]) for service in made]
    lost = [str(loss) for pair in pairs for loss in compare(*pair, model.metamodels, EXACT)]
    # States of inherited machines are said again, also where the others left them out.
    assert all("/ReceiveFSM/" in loss and ": states: nothing" in loss for loss in lost), lost
    assert is_the_same_again(exported)


def test_every_kind_of_field_comes_back():
    result = winch()
    (service,) = result.sets[0].services
    exported = export_jsidl(result.model, [service])
    assert exported.diagnostics == []
    _, found = again(exported)
    (imported,) = (candidate for candidate in found.values() if candidate.urn == service.urn)
    # Only transitions for all triggers stand behind the others, as AS5684 has it.
    but_machines = Policy(frozenset({"machines"}))
    assert compare(service, imported, result.model.metamodels, but_machines) == []
    assert differences(service, imported, result.model.metamodels) == []


def transitions(data):
    """Returns what each transition of a file is on, its parameters, and the arguments in it."""
    found = []
    for element in etree.fromstring(data).iter("{*}transition"):
        parameters = {e.get("value"): e.get("type") for e in element.iterfind("{*}parameter")}
        given = [e.get("value") for e in element.iterfind("{*}action/{*}argument")]
        for guard in element.iterfind("{*}guard"):
            given += re.findall(r"\w\s*\(\s*(\w+)\s*\)", guard.get("condition"))
        arguments = {e.strip() for e in given if e.strip()[:1] not in "'0123456789"}
        found.append((element.get("name").rpartition(".")[2], parameters, arguments))
    return found


def test_each_argument_of_a_transition_keeps_the_parameter_that_types_it():
    """The code generator of the JAUS Tool Set knows the type of an argument from there alone."""
    check_arguments(WINCH[0].parent)


@pytest.mark.beside("jsidl")
@for_each("path", sets_of_others)
def test_so_it_is_in_the_sets_of_others(path):
    check_arguments(path)


def check_arguments(path):
    """Holds the transitions of an export against those of the files in a folder."""
    files = sorted(file for file in path.rglob("*") if file.suffix in (".xml", ".jsidl"))
    result = import_jsidl(files)
    made = [service for root in result.sets for service in root.services]
    exported = export_jsidl(result.model, made).documents
    written = [transition for data in exported.values() for transition in transitions(data)]
    given = [transition for file in files for transition in transitions(file.read_bytes())]
    assert given
    for on, parameters, arguments in given:
        if on != "Receive":
            assert (on, parameters, arguments) in written
        for name in arguments & {*parameters} - {"transportData"}:
            assert any(name in also and also[name] == parameters[name] for _, also, _ in written)
    assert all(arguments <= {*parameters} for _, parameters, arguments in written)


@pytest.mark.slow
@for_each("path", [*SETS, OWN])
def test_no_argument_of_an_exported_transition_is_without_a_type(path):
    model = read_models([path]).model
    for data in export_jsidl(model, services(model)).documents.values():
        for _, parameters, arguments in transitions(data):
            assert arguments <= {*parameters}


def test_the_types_of_what_comes_and_goes_are_those_of_transport():
    """What a parameter says: Receive.Body.ReceiveRec is declared in the library."""
    model = read_models([CORE]).model
    documents = export_jsidl(model, services(model)).documents
    (data,) = (data for name, data in documents.items() if "Transp" in name)
    events = etree.fromstring(data).iterfind(f"{JSIDL}internal_events_set/{JSIDL}event_def")
    bodies = {event.get("name"): event.find(f"{JSIDL}body/{JSIDL}record") for event in events}
    assert {name: [field.get("name") for field in body] for name, body in bodies.items()} == {
        "Send": [None, "ReliableDelivery", "DestinationID", "SourceID", "Priority", PAYLOAD],
        "BroadcastLocal": [None, "DestinationID", "SourceID", "Priority", PAYLOAD],
        "BroadcastGlobal": [None, "DestinationID", "SourceID", "Priority", PAYLOAD],
        "Receive": ["SourceID", PAYLOAD],
    }
    assert bodies["Receive"].get("name") == "ReceiveRec"


@pytest.mark.parametrize(
    ("guard", "condition"),
    [
        ("paysOut", "paysOut(msg)"),
        ("!(paysOut || paysIn)", "!paysOut(msg) && !paysIn(msg)"),
        ("!(paysOut && paysIn)", "!paysOut(msg) || !paysIn(msg)"),
        ("!(paysOut && !(paysIn || slow))", "!paysOut(msg) || paysIn(msg) || slow(msg)"),
        ("(paysOut || paysIn) && slow", "paysOut(msg) && slow(msg) || paysIn(msg) && slow(msg)"),
        (
            "isControllingClient && !(lasts(msg, '3') && slow(msg))",
            "isControllingClient(transportData) && !lasts(msg, '3')"
            " || isControllingClient(transportData) && !slow(msg)",
        ),
        # Without its parentheses a guard of so many alternatives would be no guard any more.
        (
            " && ".join(["(paysOut || paysIn || slow || steady)"] * 4),
            " && ".join(["(paysOut(msg) || paysIn(msg) || slow(msg) || steady(msg))"] * 4),
        ),
    ],
)
def test_a_guard_has_no_parentheses_around_conditions_and_means_the_same(guard, condition):
    """The code generator of the JAUS Tool Set copies parentheses into names of methods."""
    model = read_models([OWN]).model
    (service,) = services(model)
    locking = next(e for e in model.instances(jaus.State) if e.name == "Locked").transitions[0]
    locking.guard = guard
    ((name, data),) = export_jsidl(model, [service]).documents.items()
    conditions = [element.get("condition") for element in etree.fromstring(data).iter("{*}guard")]
    assert condition in conditions
    (imported,) = import_sources([Source(name, data)]).sets[0].services
    changed = differences(service, imported, model.metamodels)
    assert [difference for difference in changed if difference.feature == "guard"] == []


def test_of_an_own_service_the_names_of_what_makes_messages_are_lost():
    model = read_models([OWN]).model
    exported = export_jsidl(model, services(model))
    _, found = again(exported)
    (imported,) = found.values()
    (service,) = services(model)
    assert compare(service, imported, model.metamodels, Policy(frozenset({"machines"}))) == []
    told = [
        (diagnostic.rule, diagnostic.location.line, diagnostic.message.rpartition(": ")[2])
        for diagnostic in exported.diagnostics
        if diagnostic.rule != "JML631"
    ]
    source = OWN.read_text(encoding="utf-8").splitlines()
    assert len(told) == 3
    for rule, line, message in told:
        assert rule == "JML632"
        name = source[line - 1].partition('name="')[2].partition('"')[0]
        assert message.startswith(f"action is {name} sends ")


def declared(tmp_path):
    path = tmp_path / "light.xmi"
    path.write_text(DECLARED, encoding="utf-8")
    result = read_models([path])
    assert result.diagnostics == []
    return result.model


def test_declared_types_are_declared_once(tmp_path):
    model = declared(tmp_path)
    exported = export_jsidl(model, services(model))
    (data,) = exported.documents.values()
    root = etree.fromstring(data)
    types = root.find(f"{JSIDL}declared_type_set")
    assert [declaration.get("name") for declaration in types] == ["Colour", "Share"]
    (front, back) = root.iter(f"{JSIDL}declared_record")
    assert (front.get("declared_type_ref"), front.get("optional")) == ("Colour", "true")
    assert (back.get("name"), back.get("optional")) == ("Back", "false")
    _, found = again(exported)
    (body,) = (message.body for message in next(iter(found.values())).inputs)
    assert [type(field).__name__ for field in body.fields] == ["Record"] * 3
    assert body.fields[0].fields[0].units == "percent"


def test_all_that_jsidl_cannot_say_is_told_where_it_stands(tmp_path):
    model = declared(tmp_path)
    source = DECLARED.splitlines()
    found = export_jsidl(model, services(model)).diagnostics
    told = [(finding.rule, source[finding.location.line - 1].strip()[:48]) for finding in found]
    assert told == [
        ("JML631", '<fields xsi:type="jaus:FixedField" name="Bearing'),
        ("JML631", '<formats name="BMP" index="0" documentation="Wit'),
        ("JML632", '<actions name="tell" sends="//@services.0/@outpu'),
    ]
    assert found[0].message.endswith("'frame' of Bearing, Back")
    assert found[-1].message.endswith("after an import sendReportLamp")


def test_a_file_has_what_as5684_asks_for_in_its_order():
    model = read_models(SETS).model
    for data in export_jsidl(model, services(model)).documents.values():
        root = etree.fromstring(data)
        parts = [etree.QName(element).localname for element in root]
        assert parts == [word for word in PARTS.split() if word in parts]
        assert {*PARTS.split()} - {*parts} <= {"references", "declared_type_set"}
        for message in root.iter(f"{JSIDL}message_def"):
            names = [etree.QName(element).localname for element in message]
            assert names == ["description", "header", "body", "footer"]
        assert root.find(f"{JSIDL}protocol_behavior/{JSIDL}state_machine/{JSIDL}state") is not None


@pytest.mark.parametrize(
    ("written", "other", "place"),
    [
        ('real_upper_limit="2"', 'real_upper_limit="3"', "RopeSpeed"),
        ('field_units="newton"', 'field_units="meter"', "Tension"),
        ('enum_index="2"', 'enum_index="9"', "PAYING_OUT"),
        (
            "!paysOut(msg) &amp;&amp; !paysIn",
            "!paysOut(msg) || !paysIn",
            "Moving/defaults on SetWinchCommand 1",
        ),
        (
            '"Receiving.Ready.Controlled.Available.Ready.Locked"',
            '"Receiving"',
            "Ready/defaults on LockBrake 1",
        ),
        ('<action name="stopMotor"', '<action name="stop"', "Moving/exit"),
        ('initial_state="Idle"', 'initial_state="Locked"', "Available.Ready"),
        ("<internal />", "<simple />", "Receiving.Ready/defaults on QueryWinchState 1"),
        ("What the winch does in the states", "What", "ReceiveFSM"),
    ],
)
def test_a_mistake_of_the_export_would_be_told(written, other, place):
    """What finds the losses finds each of these, so that none would go unnoticed."""
    model = read_models([OWN]).model
    (service,) = services(model)
    ((name, data),) = export_jsidl(model, [service]).documents.items()
    assert written.encode() in data
    changed = data.replace(written.encode(), other.encode())

    def told(content):
        (imported,) = import_sources([Source(name, content)]).sets[0].services
        return {str(difference) for difference in differences(service, imported, model.metamodels)}

    new = told(changed) - told(data)
    assert any(place in difference for difference in new), new


def test_two_services_of_one_urn_are_no_jsidl(tmp_path):
    model = declared(tmp_path)
    (service,) = services(model)
    twin = winch().sets[0].services[0]
    twin.urn, twin.version = service.urn, service.version
    exported = export_jsidl(model, [service, twin])
    (found,) = (diagnostic for diagnostic in exported.diagnostics if diagnostic.rule == "JML633")
    assert "is declared twice" in found.message


def test_the_files_of_the_winch_are_there():
    assert len(WINCH) == 4
