"""Services and messages by name and code."""

import pytest

from jausml.live.messages import (
    AmbiguousMessageError,
    CatalogueError,
    DecodeError,
    DefinitionError,
    EncodeError,
    UnknownMessageError,
    UnknownServiceError,
    load_catalogue,
)

MANAGEMENT = "urn:jaus:jss:core:Management"
REPORT_STATUS = bytes.fromhex("02400100000000")

OWN = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="own">
 <services name="{name}" urn="{urn}" version="1.0">
  {inputs}
 </services>
</jaus:ServiceSet>
"""
LAMP = """<body xsi:type="jaus:Record" name="LampRec">
 <fields xsi:type="jaus:FixedField" name="Level"/></body>"""


def model(folder, *bodies, name="Lamp", urn="urn:own:Lamp"):
    """Returns the path of a model with a message of each body: SetLamp0 with code 0xD000 and on."""
    inputs = "".join(
        f'<inputs name="SetLamp{number}" code="0xD0{number:02}">{body}</inputs>'
        for number, body in enumerate(bodies or [LAMP])
    )
    path = folder / "own.xmi"
    path.write_text(OWN.format(inputs=inputs, name=name, urn=urn), encoding="utf-8")
    return path


def test_the_library_is_listed(catalogue):
    assert len(catalogue.services) == 93
    service = catalogue.services[MANAGEMENT, "1.1"]
    assert (service.name, service.set_name, service.set_version) == ("Management", "core", "1.1")
    assert service.inherits is catalogue.services["urn:jaus:jss:core:AccessControl", "1.1"]
    assert [entry.name for entry in service.outputs] == ["ReportStatus"]
    assert "Shutdown" in [entry.name for entry in service.inputs]
    codes = [entry.code for entry in catalogue.messages]
    assert codes == sorted(codes)
    assert len({(entry.name, entry.code) for entry in catalogue.messages}) > 300


def test_equal_definitions_are_one_message(catalogue):
    (entry,) = catalogue.find(0x4002)
    assert [service.version for service in entry.services] == ["1.0", "1.1"]
    assert entry in catalogue.services[MANAGEMENT, "1.0"].outputs
    assert entry in catalogue.services[MANAGEMENT, "1.1"].outputs
    assert not entry.is_command
    assert catalogue.message("Shutdown").is_command


@pytest.mark.parametrize("service", ["Management", MANAGEMENT, "core:Management", "Management/1.1"])
def test_messages_of_a_service(catalogue, service):
    assert catalogue.message("ReportStatus", service).code == 0x4002
    assert catalogue.message("0x4002", service) is catalogue.message(0x4002, service)
    assert catalogue.message("4002").name == "ReportStatus"


def test_a_service_has_the_messages_that_it_inherits(catalogue):
    assert catalogue.message("CreateEvent", "GlobalPoseSensor").code == 0x01F0
    assert catalogue.find(0x4002, "GlobalPoseSensor") == ()


@pytest.mark.parametrize(
    ("name", "service", "suggestion"),
    [
        ("ReportStatu", None, "did you mean ReportStatus"),
        ("reportstatus", None, "did you mean ReportStatus"),
        ("ReportStatus", "GlobalPoseSensor", "urn:jaus:jss:core:Management/1.0"),
        ("0xFFFF", None, "no message has the code 0xFFFF"),
        ("0240", None, "no message has the code 0x0240; with its bytes swapped it is ReportStatus"),
    ],
)
def test_unknown_messages(catalogue, name, service, suggestion):
    with pytest.raises(UnknownMessageError, match=suggestion):
        catalogue.message(name, service)


@pytest.mark.parametrize(
    ("service", "suggestion"),
    [
        ("Managment", "did you mean Management"),
        ("Management/7.0", "Management/1.0 or Management/1.1"),
        ("urn:jaus:jss:core:managment", MANAGEMENT),
        ("", "no service ''"),
    ],
)
def test_unknown_services(catalogue, service, suggestion):
    with pytest.raises(UnknownServiceError, match=suggestion):
        catalogue.message("ReportStatus", service)
    with pytest.raises(UnknownServiceError, match=suggestion):
        catalogue.find(0x4002, service)


def test_ambiguous_names_list_their_meanings(catalogue):
    with pytest.raises(AmbiguousMessageError) as caught:
        catalogue.message("ReportManipulatorSpecifications")
    assert len(caught.value.choices) == 2
    assert "ManipulatorSpecificationService/2.0" in str(caught.value)
    service = "ManipulatorSpecificationService"
    assert catalogue.message("ReportManipulatorSpecifications", service).code == 0x4600


def test_ambiguous_codes_are_told_apart_by_the_bytes_or_by_the_service(catalogue):
    command = catalogue.message("CBRNScanWindowConfigurationCommand")
    query = catalogue.message("QueryMeasurement")
    assert command.code == query.code == 0xF92A
    assert catalogue.decode(bytes.fromhex("2af9")).entry is query
    with pytest.raises(AmbiguousMessageError, match=r"QueryJointPosition of .*QueryJointPositions"):
        catalogue.decode(bytes.fromhex("0226"))
    service = "ManipulatorJointPositionSensor/2.0"
    decoded = catalogue.decode(bytes.fromhex("0226"), service)
    assert decoded.entry.name == "QueryJointPositions"
    assert decoded.service.label.endswith(service)
    # The service only chooses: other messages of a conversation remain readable.
    assert catalogue.decode(REPORT_STATUS, service).entry.name == "ReportStatus"


def test_unknown_codes(catalogue):
    with pytest.raises(UnknownMessageError, match=r"no message has the code 0xFFFF$"):
        catalogue.decode(b"\xff\xff")
    with pytest.raises(UnknownMessageError, match="bytes swapped it is ReportStatus"):
        catalogue.decode(b"\x40\x02")
    with pytest.raises(DecodeError, match="1 bytes are too few for a message code"):
        catalogue.decode(b"\x02")


def test_own_models_are_known_too(tmp_path):
    catalogue = load_catalogue([model(tmp_path)])
    decoded = catalogue.decode(bytes.fromhex("00d007"))
    assert decoded.to_json() == {
        "message": "SetLamp0",
        "code": "0xD000",
        "service": "urn:own:Lamp",
        "service_version": "1.0",
        "fields": {"LampRec": {"Level": 7}},
    }
    assert catalogue.message("ReportStatus").code == 0x4002


def test_an_own_service_takes_the_place_of_the_library_s(tmp_path):
    catalogue = load_catalogue([model(tmp_path, urn=MANAGEMENT, name="Management")])
    messages = catalogue.services[MANAGEMENT, "1.0"].messages
    assert [message.name for message in messages] == ["SetLamp0"]
    assert catalogue.message("SetLamp0", "Management").name == "SetLamp0"


def test_it_has_nothing_of_the_service_whose_place_it_takes(tmp_path):
    path = model(tmp_path, urn="urn:jaus:jss:core:AccessControl", name="AccessControl")
    path.write_text(path.read_text("utf-8").replace('version="1.0"', 'version="1.1"'), "utf-8")
    catalogue = load_catalogue([path])
    service = catalogue.services["urn:jaus:jss:core:AccessControl", "1.1"]
    assert service.inherits is None
    assert catalogue.services[MANAGEMENT, "1.1"].inherits is service
    relations = {message.name: message.relations for message in catalogue.messages}
    assert relations["SetLamp0"].exchange is None


def test_a_model_that_cannot_be_read_says_where(tmp_path):
    path = model(tmp_path, "<nonsense/>")
    with pytest.raises(CatalogueError, match=r"own\.xmi:6:\d+: JML103"):
        load_catalogue([path])
    with pytest.raises(CatalogueError, match=r"absent\.xmi"):
        load_catalogue([tmp_path / "absent.xmi"])


MEANINGLESS = [
    (
        '<body xsi:type="jaus:TypeReference" name="B" target="//@services.0/@inputs.0/@body"/>',
        "B: the type reference leads to no type",
    ),
    (
        '<body xsi:type="jaus:Record" name="R"><fields xsi:type="jaus:List" name="L">'
        '<element xsi:type="jaus:TypeReference" name="E"'
        ' target="//@services.0/@inputs.1/@body"/>'
        "</fields></body>",
        "R.L.E: it contains itself",
    ),
    (
        '<body xsi:type="jaus:Record" name="R"><fields xsi:type="jaus:FixedField" name="F"/>'
        '<fields xsi:type="jaus:FixedField" name="F"/></body>',
        "R: the name 'F' is taken twice",
    ),
    (
        '<body xsi:type="jaus:Record" name="R"><fields xsi:type="jaus:FixedField" name="F"'
        ' type="int8"><scale lower="0" upper="1"/></fields></body>',
        r"R.F: 0.0 .. 1.0 is no scale of int8",
    ),
    (
        '<body xsi:type="jaus:List" name="L" countType="int8">'
        '<element xsi:type="jaus:FixedField" name="F"/></body>',
        "L: int8 is no unsigned integer",
    ),
    (
        '<body xsi:type="jaus:Array" name="A"><element xsi:type="jaus:FixedField" name="F"/>'
        "<dimensions>100000</dimensions><dimensions>100000</dimensions></body>",
        "A: dimensions",
    ),
    (
        '<body xsi:type="jaus:BitField" name="B"><subFields name="S" lowBit="4" highBit="8"/>'
        "</body>",
        r"B.S: bits 4 .. 8 do not fit",
    ),
]


@pytest.fixture(scope="module")
def meaningless(tmp_path_factory):
    bodies = (body for body, _ in MEANINGLESS)
    return load_catalogue([model(tmp_path_factory.mktemp("meaningless"), *bodies)])


@pytest.mark.parametrize("number", range(len(MEANINGLESS)))
def test_definitions_without_a_meaning_harm_only_their_message(meaningless, number):
    name, (_, reason) = f"SetLamp{number}", MEANINGLESS[number]
    assert meaningless.decode(REPORT_STATUS).entry.name == "ReportStatus"
    with pytest.raises(DefinitionError, match=f"{name}.{reason}"):
        meaningless.decode(bytes([number, 0xD0, 0]))
    with pytest.raises(DefinitionError, match=f"{name}.{reason}"):
        meaningless.message(name).encode({})


def test_a_message_is_named_by_name_or_code(catalogue):
    fields = {"ReportStatusRec": {"Status": 1, "Reserved": 0}}
    for message in (
        {"message": "ReportStatus", "fields": fields},
        {"code": "4002", "fields": fields},
        {"code": 0x4002, "fields": fields},
        {"message": "ReportStatus", "code": "0x4002", "service": "Management", "fields": fields},
        {
            "message": "ReportStatus",
            "service": MANAGEMENT,
            "service_version": "1.1",
            "fields": fields,
        },
    ):
        assert catalogue.encode(message) == REPORT_STATUS
    assert catalogue.encode({"message": "Shutdown"}) == b"\x02\x00"


@pytest.mark.parametrize(
    ("message", "error", "reason"),
    [
        ({}, EncodeError, "neither 'message' nor 'code'"),
        ({"message": 7}, EncodeError, "message: 7 is no message"),
        ({"code": True}, EncodeError, "code: true is no code"),
        ({"code": "0x40021"}, EncodeError, "code: '0x40021' is not a code of four"),
        (
            {"message": "ReportStatus", "code": "2002"},
            EncodeError,
            "code: ReportStatus has the code",
        ),
        ({"message": "ReportStatus", "code": "x"}, EncodeError, "code: 'x' is not a code"),
        ({"message": "ReportStatus", "feilds": {}}, EncodeError, "feilds: unknown field; did you"),
        ({"message": "ReportStatus", "service_version": "1"}, EncodeError, "nothing without"),
        ({"message": "ReportStatus", "service": 1}, EncodeError, "service: 1 is not a string"),
        ({"message": "ReportStatus", "fields": []}, EncodeError, "fields: a list of 0"),
        ({"message": "ReportStat"}, UnknownMessageError, "did you mean ReportStatus"),
        ({"message": "ReportStat", "code": "4002"}, UnknownMessageError, "did you mean"),
        ({"message": "QueryStatus", "service": "X"}, UnknownServiceError, "no service 'X'"),
        ({"message": "ReportManipulatorSpecifications"}, AmbiguousMessageError, "meanings"),
    ],
)
def test_wrong_objects(catalogue, message, error, reason):
    with pytest.raises(error, match=reason):
        catalogue.encode(message)


def test_what_a_service_takes_below_the_codes_of_queries_commands(catalogue):
    """The JSIDL of ExecuteList forgets to say so, in six services."""
    inputs = [entry for service in catalogue.services.values() for entry in service.inputs]
    assert [entry.name for entry in inputs if entry.code < 0x2000 and not entry.is_command] == []
