"""What has drifted between a user's file and the model, told without importing the file."""

import pytest

from jausml.generation.artifact import Artifact, Kind, MethodContract, SkeletonContract
from jausml.generation.contract.finding import FindingKind as F
from jausml.generation.drift import drift
from jausml.generation.manifest import MANIFEST_PATH, Manifest, read_manifest

SKELETON = "vehicle/vehicle.py"
HEAD = "from .vehicle_base import VehicleBase\n\n\nclass Vehicle(VehicleBase):\n"
SPEED = "    def on_set_speed(self, message): ...\n"
POSE = "    def on_report_pose(self, message): ...\n"


@pytest.fixture
def findings(workspace, vehicle):
    workspace.write([vehicle])

    def run(text, model=None):
        data = text if isinstance(text, bytes) else text.encode("utf-8")
        workspace.path(SKELETON).write_bytes(data)
        found = workspace.drift(model or [vehicle])
        assert workspace.path(SKELETON).read_bytes() == data
        return found

    return run


def told(found):
    return [(finding.kind, finding.line) for finding in found]


def test_a_complete_file_has_no_findings(findings):
    assert findings(HEAD + SPEED + POSE + "    def helper(self): ...\n") == []


def test_a_fresh_skeleton_lacks_every_method(workspace, vehicle):
    assert workspace.drift([vehicle]) == []  # nothing written yet

    workspace.write([vehicle])

    found = workspace.drift([vehicle])
    assert [f.kind for f in found] == [F.MISSING, F.MISSING]
    assert {f.severity.value for f in found} == {"info"}
    assert found[0].path == SKELETON


def test_a_missing_method_comes_with_a_stub(findings):
    (found,) = findings(HEAD + SPEED)

    assert found.kind is F.MISSING
    assert found.line == 4
    assert "on_report_pose(self, message)" in found.message
    assert found.stub == "def on_report_pose(self, message: bytes) -> None: ..."


def test_an_optional_method_is_not_missed(workspace, vehicle):
    workspace.write([vehicle])
    method = MethodContract("on_start", (), "hook:start", "", optional=True)
    contract = SkeletonContract("Vehicle", "VehicleBase", (method,))
    artifact = Artifact(SKELETON, "", Kind.SKELETON, "c", "m", "t", contract=contract)

    assert drift([artifact], workspace.out, Manifest()) == []


def test_an_orphan_method_is_a_warning_with_its_line(findings):
    (found,) = findings(HEAD + SPEED + POSE + "    def translate_odometry(self, m): ...\n")

    assert (found.kind, found.line, found.severity.value) == (F.ORPHAN, 7, "warning")
    assert "translate_odometry" in found.message


def test_a_renamed_message_is_known_by_its_code(workspace, findings, vehicle, make_message, rename):
    text = HEAD + SPEED + POSE
    model = [rename(vehicle, messages=(make_message("go", 0x0401), vehicle.messages[1]))]

    (found,) = findings(text, model)
    assert (found.kind, found.line) == (F.RENAMED, 5)
    assert found.message == "on_set_speed: renamed to on_go"
    assert "def on_go" in found.stub

    workspace.write(model)  # the manifest keeps the former name
    assert findings(text, model) == [found]


def test_another_message_of_a_similar_name_is_no_rename(findings, vehicle, make_message, rename):
    model = [rename(vehicle, messages=(make_message("set_speeds", 0x0999), vehicle.messages[1]))]

    assert told(findings(HEAD + SPEED + POSE, model)) == [(F.MISSING, 4), (F.ORPHAN, 5)]


def test_without_a_manifest_similar_names_are_asked_about(workspace, findings):
    workspace.path(MANIFEST_PATH).unlink()

    (found,) = findings(HEAD + POSE + "    def on_set_speedd(self, message): ...\n")
    assert found.kind is F.RENAMED

    two = "    def on_set_speedd(self, m): ...\n    def on_set_speeed(self, m): ...\n"
    assert [f.kind for f in findings(HEAD + POSE + two)] == [F.MISSING, F.ORPHAN, F.ORPHAN]
    other = "    def on_xyz(self, message): ...\n"
    assert [f.kind for f in findings(HEAD + POSE + other)] == [F.MISSING, F.ORPHAN]


@pytest.mark.parametrize(
    "method",
    [
        "def on_set_speed(self, message): ...",
        "def on_set_speed(self, msg): ...",
        "def on_set_speed(self, _message, extra=1): ...",
        "def on_set_speed(self, *args): ...",
        "def on_set_speed(self, message, /, *, debug=False): ...",
        "def on_set_speed(self, *args, **kwargs): ...",
        "on_set_speed = print",
        "on_set_speed: object = print",
    ],
)
def test_signatures_that_take_the_call(findings, method):
    assert findings(f"{HEAD}    {method}\n{POSE}") == []


@pytest.mark.parametrize(
    ("method", "reason"),
    [
        ("def on_set_speed(self): ...", "takes ()"),
        ("def on_set_speed(self, message, source): ...", "takes (message, source)"),
        ("def on_set_speed(self, message, *, source): ...", "requires keyword arguments"),
        ("def on_set_speed(self, source=None, message=None): ...", "in another order"),
        ("async def on_set_speed(self, message): ...", "is async"),
        ("@staticmethod\n    def on_set_speed(message): ...", "is a static method"),
    ],
)
def test_signatures_that_differ(findings, method, reason):
    (found,) = findings(f"{HEAD}    {method}\n{POSE}")

    assert found.kind is F.SIGNATURE
    assert reason in found.message
    assert "expected on_set_speed(self, message)" in found.message


def test_methods_in_branches_and_in_bases_of_the_same_file_count(findings):
    text = (
        "from .vehicle_base import VehicleBase as Base\n"
        "class Mixin:\n" + SPEED + "class Vehicle(Mixin, Base):\n"
        "    if True:\n        x = 1\n    else:\n        pass\n"
        "    try:\n        def on_report_pose(self, message): ...\n"
        "    except ImportError:\n        pass\n"
    )

    assert findings(text) == []


@pytest.mark.parametrize(
    ("head", "base_ok"),
    [
        ("class Vehicle(VehicleBase):\n", True),
        ("class Vehicle(vehicle_base.VehicleBase):\n", True),
        ("class Vehicle(VehicleBase[int]):\n", True),
        ("class Middle(VehicleBase): ...\nclass Vehicle(Middle):\n", True),
        ("class Vehicle:\n", False),
        ("class Vehicle(Other):\n", False),
        ("class Vehicle(make_base()):\n", False),
    ],
)
def test_the_base_class(findings, head, base_ok):
    found = findings(head + SPEED + POSE)

    assert [f.kind for f in found] == ([] if base_ok else [F.NO_BASE])


def test_a_missing_class_and_its_likely_new_name(findings):
    (found,) = findings("import os\n\n\nclass Car(VehicleBase):\n" + SPEED + POSE)

    assert (found.kind, found.line) == (F.NO_CLASS, 4)
    assert "is it Car" in found.message
    assert [f.kind for f in findings("")] == [F.NO_CLASS]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("class Vehicle(:\n", 1),
        ("x = 1\n\ndef f(:\n", 3),
        (b"x = '\xff'\n", 1),
        (b"a\x00b\n", 1),
        ("<<<<<<< ours\n", 1),
        ("(" * 5000, 1),
    ],
)
def test_a_file_that_is_not_python_is_a_finding(findings, text, line):
    (found,) = findings(text)

    assert (found.kind, found.severity.value) == (F.SYNTAX, "error")
    assert found.line == line


def test_encodings_and_odd_escapes_of_the_user_are_read(findings):
    text = "# coding: latin-1\nNAME = 'é'\nPATTERN = '\\d'\n" + HEAD + SPEED + POSE

    assert findings(text.encode("latin-1")) == []
    assert findings(b"\xef\xbb\xbf" + (HEAD + SPEED + POSE).encode()) == []


def test_the_users_code_is_never_run(findings, tmp_path):
    canary = tmp_path / "ran"
    text = f"open({str(canary)!r}, 'w')\nraise SystemExit\n" + HEAD + SPEED + POSE

    assert findings(text) == []
    assert not canary.exists()


def test_a_linked_file_is_not_read(workspace, vehicle, tmp_path):
    workspace.write([vehicle])
    (tmp_path / "secret.py").write_text("(", encoding="utf-8")
    workspace.path(SKELETON).unlink()
    workspace.path(SKELETON).symlink_to(tmp_path / "secret.py")

    assert workspace.drift([vehicle]) == []


def test_paths_outside_are_not_read(workspace):
    contract = SkeletonContract("X", "XBase", ())
    artifact = Artifact("../x.py", "", Kind.SKELETON, "c", "m", "t", contract=contract)
    (workspace.out.parent / "x.py").write_text("(", encoding="utf-8")
    workspace.out.mkdir()

    assert drift([artifact], workspace.out, Manifest()) == []


FACE = 'from .component.base import Guard as Guard, Scope\n\n__all__ = ["Scope"]\n'
MODULES = {"__init__": FACE, "component/__init__": "", "component/base": "class Guard: ...\n"}


@pytest.fixture
def told_of_import(workspace, vehicle):
    """Returns what is said of a line in a skeleton, beside a runtime of three modules."""
    workspace.write([vehicle])
    runtime = [
        Artifact(
            f"jausml_runtime/jausml_runtime/{name}.py",
            text,
            Kind.GENERATED,
            element_id="runtime",
            source="runtime",
            target="runtime",
        )
        for name, text in MODULES.items()
    ]

    def run(line):
        workspace.path(SKELETON).write_text(f"{line}\n{HEAD}{SPEED}{POSE}", encoding="utf-8")
        artifacts = [*workspace.render([vehicle]), *runtime]
        return drift(artifacts, workspace.out, read_manifest(workspace.out))

    return run


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "from jausml_runtime.process import Guard, Scope",
            "there is no module jausml_runtime.process any more; "
            "write `from jausml_runtime import Guard, Scope`",
        ),
        (
            "from jausml_runtime.component import Guard",
            "jausml_runtime.component has no Guard any more; "
            "write `from jausml_runtime import Guard`",
        ),
        (
            "from jausml_runtime.process import Hidden",
            "there is no module jausml_runtime.process any more; nothing uses it, take it out",
        ),
    ],
)
def test_an_import_of_what_is_gone_says_where_it_went(told_of_import, line, message):
    (found,) = told_of_import(line)

    assert (found.kind, found.line, found.severity.value) == (F.IMPORT, 1, "error")
    assert found.message == message


@pytest.mark.parametrize(
    "line",
    [
        "from jausml_runtime import Guard",
        "from jausml_runtime.component import base",
        "from jausml_runtime.component.base import Guard",
        "from os.path import join",
        "from .component import Guard",
        "from jausml_runtime_tools.component import Guard",
    ],
)
def test_imports_of_what_is_there_are_no_finding(told_of_import, line):
    assert told_of_import(line) == []


def test_a_file_that_the_user_put_into_a_generated_package_is_theirs(told_of_import, workspace):
    workspace.path("jausml_runtime/jausml_runtime").mkdir(parents=True)
    workspace.path("jausml_runtime/jausml_runtime/own.py").write_text("X = 1\n")

    assert told_of_import("from jausml_runtime.own import X") == []
