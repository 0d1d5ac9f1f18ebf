"""`jausml case`: what it writes, which evidence it takes, and what a case may lose."""

import json
import shutil
from hashlib import sha256
from pathlib import Path

import pytest
from lxml import etree

GUARDS = ("jausml/safety_case", "jausml/views/diagrams")

ROOT = Path(__file__).resolve().parents[2]
CAR = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
MOWER = ROOT / "tests" / "safety_case" / "mower.ros2jaus"


@pytest.fixture
def mower(here):
    """A current folder with a model of which each hazard is answered."""
    shutil.copy(MOWER, here)
    return here / MOWER.name


def digest(path):
    return sha256(path.read_bytes()).hexdigest()


def proof(model, *found, path="proof.json"):
    """Writes a proof of the map of the connection drive, of a model as it is."""
    fields = [{"tried": 1000, "total": 1 << 32}]
    content = {
        "digests": {model.name: digest(model)},
        "maps": [{"name": "velocity_command", "fields": fields, "found": list(found)}],
    }
    file = model.with_name(path)
    file.write_text(json.dumps(content), encoding="utf-8")
    return file


def made(jausml, model, *options):
    result = jausml("case", model, "-o", "case", *options)
    assert result.exit_code == 0, result.output
    return json.loads(Path("case/case.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def drawn():
    """Cases that were drawn, by what they rest on: to draw one takes most of a test."""
    return {}


@pytest.fixture
def begun(jausml, mower, drawn, tmp_path_factory):
    """Makes the case with which a test begins, with evidence; returns it as JSON."""

    def make(*evidence):
        rests = tuple((path.name, path.read_bytes()) for path in (mower, *evidence))
        if rests in drawn:
            shutil.copytree(drawn[rests], "case")
            return json.loads(Path("case/case.json").read_text(encoding="utf-8"))
        case = made(jausml, mower, *(f"--evidence={path}" for path in evidence))
        drawn[rests] = shutil.copytree("case", tmp_path_factory.mktemp("drawn") / "case")
        return case

    return make


def found(jausml, model, *options):
    """Returns a case without its pictures."""
    result = jausml("case", model, "--format", "json", *options)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def goal(case, identifier):
    goals = [hazard_goal for hazard in case["hazards"] for hazard_goal in hazard["goals"]]
    return next(hazard_goal for hazard_goal in goals if hazard_goal["id"] == identifier)


def test_a_folder_with_document_json_and_pictures(jausml, mower, begun):
    case = begun()
    names = {path.name for path in Path("case").iterdir()}
    ids = [hazard["id"] for hazard in case["hazards"]]
    pictures = {f"case-{hazard_id}.svg" for hazard_id in ids}
    assert names == {"case.html", "case.json", "case.svg"} | pictures
    for path in Path("case").glob("*.svg"):
        etree.parse(path)
    assert case["model"] == {"mower.ros2jaus": digest(mower)}
    page = Path("case/case.html").read_text(encoding="utf-8")
    goals = [one for hazard in case["hazards"] for one in hazard["goals"]]
    assert page.count("\N{BALLOT BOX} accepted") == len(goals) + 1
    before = {path.name: path.read_bytes() for path in Path("case").iterdir()}
    made(jausml, mower)
    assert before == {path.name: path.read_bytes() for path in Path("case").iterdir()}


@pytest.mark.slow
def test_shapes_of_the_notation(jausml):
    page = jausml("case", CAR).stdout
    assert page.count('class="undeveloped"') > page.count(">Undeveloped: ") > 0
    for kind in ("goal", "strategy", "solution", "context", "justification"):
        assert f'class="box {kind}"' in page
    assert "Reason that a person gave: the wheels stay as they are" in page


@pytest.mark.slow
def test_json_without_a_folder(jausml):
    case = json.loads(jausml("case", CAR, "--format", "json").stdout)
    assert case["system"] == "catvehicle"
    assert not goal(case, "sensor/bridge.odometry")["supported"]


def test_names_of_a_model_are_text(jausml, mower):
    text = mower.read_text(encoding="utf-8")
    mower.write_text(text.replace("rateCap: 100", 'onSilence: hold holdReason: "<b>it & me</b>"'))
    page = jausml("case", mower).stdout
    assert "&lt;b&gt;it &amp; me&lt;/b&gt;" in page
    assert "<b>" not in page


def test_a_model_with_errors_has_undeveloped_goals(jausml, mower):
    text = mower.read_text(encoding="utf-8")
    mower.write_text(text.replace("map: velocity_command", "map: velocity_command onSilence: hold"))
    result = jausml("case", mower, "--format", "json")
    assert result.exit_code == 1
    assert "JML452" in result.stderr
    assert not goal(json.loads(result.stdout), "operator/mower.drive")["supported"]


@pytest.mark.usefixtures("folder")
def test_a_model_that_cannot_be_read_has_no_case(jausml, tmp_path):
    (tmp_path / "torn.xmi").write_text("<system", encoding="utf-8")
    result = jausml("case", "torn.xmi", "-o", "case")
    assert result.exit_code == 1
    assert "torn.xmi:" in result.stderr
    assert not (tmp_path / "case").exists()


def test_evidence_is_named_by_link_and_digest(jausml, mower, begun):
    file = proof(mower)
    case = begun(file)
    assert case["evidence"][1] == {
        "id": "E1",
        "kind": "proof",
        "path": "../proof.json",
        "sha256": digest(file),
        "stale": "",
    }
    shown = goal(case, "unit/mower.drive")
    assert [support["evidence"] for support in shown["supports"]] == ["E0", "E1"]
    assert shown["lacks"] == ["test run", "mutations"]
    assert 'href="../proof.json"' in Path("case/case.html").read_text(encoding="utf-8")
    assert checked(jausml) == (0, "")
    assert made(jausml, mower) == case  # the case knows its evidence


@pytest.mark.slow
def test_paths_that_are_no_text(jausml, mower):
    file = proof(mower).rename(mower.with_name("p\udcff<b>.json"))
    made(jausml, mower, "--evidence", file)
    page = Path("case/case.html").read_text(encoding="utf-8")
    assert 'href="../p%FF%3Cb%3E.json"' in page
    made(jausml, mower)
    assert checked(jausml) == (0, "")


def test_evidence_against_a_goal(mower, begun):
    case = begun(proof(mower, "JML922 Velocity_X is changed"))
    assert not goal(case, "unit/mower.drive")["supported"]
    page = Path("case/case.html").read_text(encoding="utf-8")
    assert "JML922 Velocity_X is changed" in page
    assert 'class="box solution against"' in page


def test_evidence_of_another_model_is_stale(jausml, mower):
    file = proof(mower)
    mower.write_text(f"{mower.read_text(encoding='utf-8')}\n// changed\n", encoding="utf-8")
    case = found(jausml, mower, "--evidence", file)
    assert case["evidence"][1]["stale"] == "is of another version of the model"
    assert "proof" in goal(case, "unit/mower.drive")["lacks"]


def test_a_list_of_digests_binds_what_names_no_model(jausml, mower):
    run = mower.with_name("run.xml")
    run.write_text(
        '<testsuites><testsuite><testcase classname="m.test_mower_translations" '
        'name="test_drive_safe_value"/></testsuite></testsuites>'
    )
    case = found(jausml, mower, "--evidence", run)
    assert "names no model" in case["evidence"][1]["stale"]
    listed = mower.with_name("run.xml.sha256")
    listed.write_text(f"{digest(mower)}  mower.ros2jaus\n{digest(run)}  run.xml\n")
    case = found(jausml, mower, "--evidence", run)
    assert case["evidence"][1]["stale"] == ""
    text = "test_drive_safe_value of test_mower_translations passed"
    shown = goal(case, "operator/mower.drive")["supports"]
    assert {"evidence": "E1", "holds": True, "text": text} in shown
    run.write_text(run.read_text().replace("/></testsuite>", "><failure/></testcase></testsuite>"))
    case = found(jausml, mower, "--evidence", run)
    assert "names no model" in case["evidence"][1]["stale"]  # the list is of another run


def checked(jausml):
    result = jausml("case", "mower.ros2jaus", "-o", "case", "--check")
    return result.exit_code, result.stderr


def test_lost_evidence_fails(jausml, mower, begun):
    file = proof(mower)
    begun(file)
    file.unlink()
    status, told = checked(jausml)
    assert status == 1
    case = Path("case/case.json").read_text(encoding="utf-8").splitlines()
    line = next(at for at, line_text in enumerate(case, start=1) if "proof.json" in line_text)
    assert f"case/case.json:{line}:1: error: JML941 evidence ../proof.json is not there" in told


def test_other_evidence_fails(jausml, mower, begun):
    begun(proof(mower))
    proof(mower, "JML922 Velocity_X is changed")
    status, told = checked(jausml)
    assert status == 1
    assert "JML941 evidence ../proof.json is another file than it was" in told
    assert "JML943 Upon wrong unit, sign or frame, a rule or a test of mower.drive" in told


def test_a_changed_model_makes_evidence_stale(jausml, mower, begun):
    begun(proof(mower))
    mower.write_text(f"{mower.read_text(encoding='utf-8')}\n// changed\n", encoding="utf-8")
    status, told = checked(jausml)
    assert status == 1
    assert "JML942 evidence ../proof.json is of another version of the model" in told


def test_a_lost_answer_fails_where_the_element_stands(jausml, mower, begun):
    begun()
    text = mower.read_text(encoding="utf-8").replace("controlTimeout: 3", "guardian: false")
    mower.write_text(text, encoding="utf-8")
    status, told = checked(jausml)
    assert status == 1
    lines = text.splitlines()
    (line,) = (at for at, text in enumerate(lines, start=1) if "connection drive" in text)
    assert f"mower.ros2jaus:{line}:9: error: JML943 Upon crash of the bridge" in told
    assert "no guardian with a stop" in told


def test_a_lost_element_fails(jausml, mower, begun):
    begun()
    text = mower.read_text(encoding="utf-8")
    mower.write_text(text.replace("connection drive", "connection steer"), encoding="utf-8")
    assert (
        "JML943 goal crash/mower.drive is gone: the model has no such element" in checked(jausml)[1]
    )


def test_a_case_out_of_date_fails(jausml, mower, begun):
    begun()
    mower.write_text(f"{mower.read_text(encoding='utf-8')}\n// changed\n", encoding="utf-8")
    status, told = checked(jausml)
    assert status == 1
    assert "case/case.json:1:1: error: JML944 the case is not what is found now" in told


@pytest.mark.parametrize("is_below", [False, True])
def test_a_document_that_was_filled_in_stays(is_below, refused, mower, begun):
    begun()
    page = Path("case/case.html")
    made = page.read_text(encoding="utf-8")
    within = made.replace("name <span></span>", "name Ada", 1)
    signed = f"{made}<p>signed: Ada</p>\n" if is_below else within
    page.write_text(signed, encoding="utf-8")
    told = "case.html has been changed by hand: move it away to keep it"
    refused(told, "case", mower, "-o", "case")
    assert page.read_text(encoding="utf-8") == signed


@pytest.mark.parametrize(
    ("name", "content", "complaint"),
    [
        ("none.json", None, "none.json is not there"),
        ("", None, "cannot be read: Is a directory"),
        ("n" * 252 + ".json", None, "cannot be read"),
        ("torn.json", "{", "torn.json is no JSON"),
        ("list.json", "[]", "list.json is no evidence that is known"),
        ("deep.json", "[" * 100_000, "deep.json is no JSON"),
        ("maps.json", '{"maps": [1]}', "maps.json is no evidence that is known"),
        ("runs.json", '{"faults": {"a": 1}}', "runs.json is no evidence that is known"),
        ("torn.xml", "<testsuite>", "torn.xml is no JUnit report"),
        ("other.xml", "<model/>", "other.xml is no JUnit report: it has no test cases"),
    ],
)
def test_bad_evidence(refused, mower, name, content, complaint):
    if content is not None:
        mower.with_name(name).write_text(content, encoding="utf-8")
    refused(complaint, "case", mower, "-o", "case", "--evidence", name)
    assert not Path("case").exists()


def test_evidence_that_is_odd_within(refused, mower):
    file = proof(mower)
    file.write_text(file.read_text(encoding="utf-8").replace('"tried": 1000', '"tried": "many"'))
    told = "proof.json holds no proof that can be read: ValueError"
    refused(told, "case", mower, "--evidence", file, "--format", "json")


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (None, "case/case.json cannot be read: No such file or directory"),
        ("{", "case/case.json is no safety case"),
        ("{}", "case/case.json is no safety case"),
        ('{"hazards": [], "evidence": [{"path": "a", "sha256": 1, "stale": ""}]}', "is no text"),
    ],
)
def test_bad_cases(refused, mower, content, complaint):
    Path("case").mkdir()
    if content is not None:
        Path("case/case.json").write_text(content, encoding="utf-8")
    refused(complaint, "case", mower, "-o", "case", "--check")


def test_wrong_options(refused, mower):
    for options in (["--check"], ["--check", "-o", "case", "--evidence", "proof.json"]):
        told = "--check takes -o DIR, and the evidence that the case there names"
        refused(told, "case", mower, *options)
