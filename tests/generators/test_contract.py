"""Code of users against the generated interface: what a change of the model breaks, and fixes."""

import json
import re
import shutil

import pytest
from click.testing import CliRunner
from generated import model_in
from sweeps import sweep

from jausml.cli import main
from jausml.generation.contract.finding import FindingKind as F
from jausml.generation.drift import drift
from jausml.generation.manifest import MANIFEST_PATH, read_manifest
from jausml.generation.rendering import render
from jausml.generation.target import load_targets
from jausml.generation.workspace import generate

GUARDS = ("jausml/generation/contract",)

MODEL = """\
import `jaus.core-1.1`

service_set farm {
    service Boom {
        urn: "urn:example:farm:Boom"
        inherits: Management
        inputs: new message_def FoldBoom {
            code: 0xD101
            isCommand: true
            record FoldBoomRec {
                fixed_field Speed { type: uint16  units: "m/s"  scale: { lower: 0  upper: 2 } }
                fixed_field Force { type: uint16  units: "N"  scale: { lower: 0  upper: 9 } }
            }
        }
        inputs: new message_def QueryBoom { code: 0xD202 }
        outputs: new message_def ReportBoom {
            code: 0xD402
            record BoomRec {
                fixed_field State {
                    values: {
                        enumerated_value folded { value: 0 }
                        enumerated_value moving { value: 1 }
                        enumerated_value unfolded { value: 2 }
                    }
                }
                fixed_field Height { type: uint16  units: "m"  scale: { lower: 0  upper: 10 } }
            }
        }
        outputs: new message_def RejectBoom { code: 0xD403 }
    }
}

system yard {
    component boom { address: 100.1.1  provides: Boom }
}
"""

CODE = '''\
"""The boom of a sprayer."""

from __future__ import annotations

from jausml_runtime import JausAddress

from .boom_base import BoomBase
from .messages import FoldBoom, QueryBoom, ReportBoom

State = ReportBoom.State


class Boom(BoomBase):
    """Folds."""

    def on_fold_boom(self, message: FoldBoom, sender: JausAddress) -> None:
        self._speed = message.speed + message.force
        self.report_changed(ReportBoom)

    def report_boom(self, query, sender):
        report = ReportBoom(state=State.UNFOLDED, height=2.0)
        report.height = 3.0
        assert report.state == ReportBoom.State["UNFOLDED"]
        return report
'''

FOLDER = "boom/boom"


TARGETS = load_targets()
PYTHON = [TARGETS[name] for name in ("jaus_component", "messages")]
WITH_RUNTIME = [*PYTHON, TARGETS["runtime"]]
"""What classes of the runtime have is known then; to generate it takes longer than all else."""


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    """The workspace of the model before it changes."""
    folder = tmp_path_factory.mktemp("farm")
    generate(model_in(folder, MODEL), PYTHON, folder / "src")
    return folder / "src"


@pytest.fixture(scope="module")
def artifacts(tmp_path_factory):
    """The files of the model before it changes."""
    return render(model_in(tmp_path_factory.mktemp("farm"), MODEL), WITH_RUNTIME)


@pytest.fixture
def yard(generated, artifacts, tmp_path):
    """Returns what a run with a changed model finds in code of the user."""
    out = tmp_path / "src"
    shutil.copytree(generated, out)

    def run(*changes: tuple[str, str], code: str | bytes = CODE, targets=PYTHON, **options):
        """Generates."""
        text = MODEL
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        data = code if isinstance(code, bytes) else code.encode()
        (out / FOLDER / "boom.py").write_bytes(data)
        return generate(model_in(tmp_path, text), targets, out, **options)

    def look(code: str | bytes = CODE):
        """Compares alone, with the model as it was."""
        data = code if isinstance(code, bytes) else code.encode()
        (out / FOLDER / "boom.py").write_bytes(data)
        return drift(artifacts, out, read_manifest(out))

    run.out, run.look = out, look
    return run


def told(found, code: str = CODE):
    """Returns what is told as pairs of a line of code and a message."""
    lines = code.splitlines()
    return [
        (lines[f.line - 1].strip(), f.severity.value, f.message)
        for f in found
        if f.kind is not F.MISSING
    ]


IMPORT = "from .messages import FoldBoom, QueryBoom, ReportBoom"


def test_code_that_fits_has_no_findings(yard):
    assert told(yard.look()) == []


def test_a_renamed_message_is_told_where_it_is_imported_and_fixed_everywhere(yard):
    change = [("FoldBoom {", "StowBoom {"), ("FoldBoomRec", "StowBoomRec")]
    found = yard(*change).drift
    lost = "boom.messages has no FoldBoom any more; it is StowBoom now"
    assert (IMPORT, "error", lost) in told(found)
    renamed = "on_fold_boom: renamed to on_stow_boom"
    assert (CODE.splitlines()[15].strip(), "warning", renamed) in told(found)
    # The next run, which cannot compare any more, still knows it by the manifest.
    assert told(yard(*change, write=False).drift) == told(found)
    result = yard(*change, fix=True)
    assert told(result.drift) == []
    expected = CODE.replace("FoldBoom", "StowBoom").replace("on_fold_boom", "on_stow_boom")
    assert (yard.out / FOLDER / "boom.py").read_text() == expected
    assert {(fix.edit.old, fix.edit.new) for fix in result.fixed} == {
        ("FoldBoom", "StowBoom"),
        ("on_fold_boom", "on_stow_boom"),
    }


def test_a_removed_message_is_an_error_and_its_import_goes_when_nothing_uses_it(yard):
    start = MODEL.index("        inputs: new message_def FoldBoom")
    removed = (MODEL[start : MODEL.index("        inputs: new message_def QueryBoom")], "")
    found = told(yard(removed).drift)
    assert (IMPORT, "error", "boom.messages has no FoldBoom any more") in found
    without = re.sub(r"    def on_fold_boom.*?\n\n", "", CODE, flags=re.DOTALL)
    unused = "boom.messages has no FoldBoom any more; nothing uses it, take it out"
    assert told(yard(removed, code=without, write=False).drift, without) == [
        (IMPORT, "error", unused)
    ]
    result = yard(removed, code=without, fix=True)
    assert told(result.drift) == []
    fixed = without.replace("import FoldBoom, ", "import ")
    assert (yard.out / FOLDER / "boom.py").read_text() == fixed


def test_a_renamed_enumerator_is_told_wherever_it_is_used(yard):
    change = ("enumerated_value unfolded {", "enumerated_value spread {")
    found = told(yard(change).drift)
    lost = "ReportBoom.State has no UNFOLDED any more; it is SPREAD now"
    assert found == [
        ("report = ReportBoom(state=State.UNFOLDED, height=2.0)", "error", lost),
        ('assert report.state == ReportBoom.State["UNFOLDED"]', "error", lost),
    ]
    yard(change, fix=True)
    text = (yard.out / FOLDER / "boom.py").read_text()
    assert text == CODE.replace("State.UNFOLDED", "State.SPREAD")


def test_a_removed_field_is_told_of_objects_and_constructors(yard):
    height = 'fixed_field Height { type: uint16  units: "m"  scale: { lower: 0  upper: 10 } }'
    assert told(yard((height, ""), targets=WITH_RUNTIME).drift) == [
        (
            "report = ReportBoom(state=State.UNFOLDED, height=2.0)",
            "error",
            "ReportBoom has no parameter height",
        ),
        ("report.height = 3.0", "error", "ReportBoom has no height any more"),
    ]


def test_a_renamed_field_is_fixed(yard):
    change = ("fixed_field Height", "fixed_field Lift")
    found = told(yard(change, targets=WITH_RUNTIME).drift)
    assert [message for _, _, message in found] == [
        "ReportBoom has no parameter height; it is lift now",
        "ReportBoom has no height any more; it is lift now",
    ]
    yard(change, fix=True, targets=WITH_RUNTIME)
    text = (yard.out / FOLDER / "boom.py").read_text()
    assert text == CODE.replace("height", "lift")


@pytest.mark.parametrize("name", ["Pace", "Rate"])
def test_a_renamed_field_is_still_known_when_its_class_is_renamed_too(yard, name):
    stow = [("FoldBoom {", "StowBoom {"), ("FoldBoomRec", "StowBoomRec")]
    yard(("fixed_field Speed", "fixed_field Pace"))
    yard(("fixed_field Speed", f"fixed_field {name}"), *stow, fix=True)
    expected = CODE.replace("FoldBoom", "StowBoom").replace("on_fold_boom", "on_stow_boom")
    fixed = expected.replace("message.speed", f"message.{name.lower()}")
    assert (yard.out / FOLDER / "boom.py").read_text() == fixed


def test_fields_that_change_their_meaning_are_not_renamed(yard):
    old = 'Height { type: uint16  units: "m"  scale: { lower: 0  upper: 10 } }'
    new = 'Lift { type: uint16  units: "m"  scale: { lower: 0  upper: 20 } }'
    result = yard((old, new), fix=True)
    assert result.fixed == ()
    assert (yard.out / FOLDER / "boom.py").read_text() == CODE


def test_parameters_of_overrides_without_annotation_are_those_of_the_base(yard):
    code = CODE.replace("message: FoldBoom, sender: JausAddress", "message, sender")
    change = ("fixed_field Force", "fixed_field Push")
    assert [line for line, *_ in told(yard(change, code=code).drift, code)] == [
        "self._speed = message.speed + message.force"
    ]


def method(body: str) -> str:
    return f"{CODE}\n    def more(self, other, *rest):\n        {body}\n"


@pytest.mark.parametrize(
    ("body", "message"),
    sweep(
        [
            ("super().more_of_it()", "BoomBase has no more_of_it"),
            ("self.report_boom_now()", "BoomBase has no report_boom_now; is it report_boom now?"),
            ("self.report_changed()", "report_changed needs report_class"),
            (
                "self.report_changed(FoldBoom, 1, 2, 3)",
                "report_changed takes 1 positional argument, not 4",
            ),
            ("ReportBoom(1, 2.0, 3)", "ReportBoom takes 2 positional arguments, not 3"),
            ("[each.size for each in [] if ReportBoom().size]", "ReportBoom has no size"),
            ("(lambda: ReportBoom().size)()", "ReportBoom has no size"),
            ("ReportBoom.Mode", "ReportBoom has no Mode"),
            ("from . import gone", "boom has no gone any more; nothing uses it, take it out"),
            ("from .gone import X; X", "there is no module boom.gone any more"),
            ("import boom.gone", "there is no module boom.gone any more"),
            ("from . import messages as m; m.Stow", "boom.messages has no Stow"),
            ("import boom.messages as m; m.Stow", "boom.messages has no Stow"),
        ],
        every=4,
    ),
)
def test_what_raises_is_an_error(yard, body, message):
    code = method(body)
    found = told(yard.look(code), code)
    assert [(severity, text) for _, severity, text in found] == [("error", message)]


@pytest.mark.parametrize(
    "body",
    sweep(
        [
            "self.mine = 1; self.mine",
            "self._private",
            "other.anything()",
            "getattr(self, 'gone')",
            "hasattr(self, 'gone') and self.gone()",
            "other = ReportBoom() if rest else other; other.size",
            "report = ReportBoom(); report = other; report.size",
            "isinstance(other, ReportBoom) and other.size",
            "ReportBoom(*rest); ReportBoom(**other)",
            "ReportBoom().encode(); ReportBoom.CODE; ReportBoom.State.FOLDED.name",
            "self.counters.count('x', 'y'); self.loop.call_later(1, print)",
            "ReportBoom.__name__; ReportBoom.State(1).value; ReportBoom.State.__members__",
            "from .helper import X; X.anything",
            "from . import helper; helper.anything",
            "from . import *",
            "import os.path as m; m.anything",
            "global State; State = other; State.NOTHING",
            "from another.messages import X",
        ],
        every=4,
    ),
)
def test_what_cannot_be_known_is_not_told(yard, body):
    body = body.replace("from . import *", "pass")
    (yard.out / FOLDER / "helper.py").write_text("X = 1\n")
    assert told(yard.look(method(body)), method(body)) == []


ODD = {
    "caught": "try:\n    from .messages import Gone\nexcept ImportError:\n    Gone = None\n",
    "star": "from .messages import *\n\nBoomed = Gone\n",
    "own star": "from os.path import *\n",
    "nothing": "",
    "nested": "def f():\n    def g(ReportBoom):\n        return ReportBoom.size\n    return g\n",
    "class": "class A:\n    ReportBoom = 1\n    x = ReportBoom.size\n",
    "match": "match [1]:\n    case [ReportBoom]:\n        ReportBoom.size\n",
    "deep": f"x = {' + '.join(['1'] * 600)}\n",
    "long": f"x = [{', '.join(['ReportBoom'] * 20000)}]\n",
    "chain": f"x = y{'.more()' * 200}\n",
    "except": "try:\n    pass\nexcept OSError as ReportBoom:\n    ReportBoom.errno\n",
}


@pytest.mark.parametrize("name", sweep(ODD, every=4))
def test_odd_files_beside_the_skeleton_are_read(yard, name):
    (yard.out / FOLDER / "odd.py").write_text(ODD[name])
    assert told(yard.look()) == []


def test_files_beside_the_skeleton_and_tests_of_the_user_are_read_too(yard):
    (yard.out / FOLDER / "helper.py").write_text("from .messages import Gone\n")
    (yard.out / "boom" / "test" / "test_own.py").write_text("from boom.messages import Gone\n")
    (yard.out / "mine" / "mine").mkdir(parents=True)
    (yard.out / "mine" / "mine" / "tool.py").write_text(
        "import boom.messages\nboom.messages.Gone\n"
    )
    places = [(f.path, f.line, f.column, f.severity.value) for f in yard.look()]
    assert places == [
        ("boom/boom/helper.py", 1, 23, "error"),
        ("boom/test/test_own.py", 1, 27, "error"),
        ("mine/mine/tool.py", 2, 15, "error"),
    ]


def test_columns_are_counted_in_characters(yard):
    (yard.out / FOLDER / "helper.py").write_text("x = 'Größe'; from .messages import Gone\n")
    (found,) = yard.look()
    assert (found.line, found.column) == (1, 36)


def test_what_type_checkers_alone_read_is_a_warning(yard):
    lines = (
        "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from .messages import Gone\n"
    )
    (yard.out / FOLDER / "helper.py").write_text(lines)
    (found,) = yard.look()
    assert (found.line, found.severity.value) == (4, "warning")


def test_a_file_that_is_no_python_is_told_and_stays(yard):
    (yard.out / FOLDER / "helper.py").write_bytes(b"x = (\n")
    (found,) = yard(fix=True).drift
    assert (found.kind, found.path, found.severity.value) == (
        F.SYNTAX,
        f"{FOLDER}/helper.py",
        "error",
    )


@pytest.mark.parametrize(
    ("encode", "end"),
    [
        (lambda text: text.encode(), "\n"),
        (lambda text: b"\xef\xbb\xbf" + text.encode(), "\r\n"),
        (lambda text: ("# coding: latin-1\n" + text).encode("latin-1"), "\r"),
    ],
)
def test_a_fix_keeps_every_other_byte(yard, encode, end):
    code = CODE.replace("Folds.", "Größe\x0c: FoldBoom.").replace(
        "message.speed +", '"ß" and message.speed +'
    )
    change = ("fixed_field Force", "fixed_field Push")
    before = encode(code).replace(b"\n", end.encode())
    path = yard.out / FOLDER / "boom.py"
    path.write_bytes(before)
    path.chmod(0o640)
    assert told(yard(change, code=before, fix=True).drift) == []
    assert path.read_bytes() == before.replace(b"message.force", b"message.push")
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize(
    ("before", "after"),
    sweep(
        [
            ("from .messages import Gone\n", ""),
            ("from .messages import Gone as G, QueryBoom\n\nQueryBoom\n",
                "from .messages import QueryBoom\n\nQueryBoom\n"),
            ("from .messages import (\n    FoldBoom,\n    Gone,  # keep\n)\n\nFoldBoom\n",
                "from .messages import (\n    FoldBoom,  # keep\n)\n\nFoldBoom\n"),
            ("from .messages import (\n    Gone,\n    FoldBoom,\n)\n\nFoldBoom\n",
                "from .messages import (\n    FoldBoom,\n)\n\nFoldBoom\n"),
            ("from .messages import (\n    Gone,  # keep\n    FoldBoom,\n)\n\nFoldBoom\n", None),
            ("from .messages import Gone  # keep\n", None),
            ("def f():\n    from .messages import Gone\n", "def f():\n    pass\n"),
            ("import os; from .messages import Gone\n", None),
            ("from .messages import Gone\n\n__all__ = ['Gone']\n", None),
            ("from .messages import Gone\n\nGone\n", None),
            ("from .gone import X\n", ""),
        ],
        every=4,
    ),
)  # fmt: skip
def test_an_import_is_taken_out_with_nothing_beside_it(yard, before, after):
    path = yard.out / FOLDER / "helper.py"
    path.write_text(before)
    result = yard(fix=True)
    assert path.read_text() == (before if after is None else after)
    assert bool(result.fixed) is (after is not None)


def test_a_name_that_others_import_keeps_it(yard):
    other = yard.out / FOLDER / "other.py"
    other.write_text("from .boom import FoldBoom\n\nFoldBoom\n")
    change = [("FoldBoom {", "StowBoom {"), ("FoldBoomRec", "StowBoomRec")]
    assert told(yard(*change, fix=True).drift) == []
    assert "import StowBoom as FoldBoom, QueryBoom" in (yard.out / FOLDER / "boom.py").read_text()


def test_a_message_that_comes_back_is_forgotten(yard):
    yard(("enumerated_value unfolded {", "enumerated_value spread {"))
    former = read_manifest(yard.out).models["yard"]["former"]
    assert former["yard_messages.boom.ReportBoom.State.UNFOLDED"] == "SPREAD"
    yard(("enumerated_value unfolded {", "enumerated_value open {"))
    former = read_manifest(yard.out).models["yard"]["former"]
    assert former["yard_messages.boom.ReportBoom.State.UNFOLDED"] == "OPEN"
    assert told(yard().drift) == []
    assert not [
        qualified_name
        for qualified_name in read_manifest(yard.out).models["yard"]["former"]
        if "UNFOLDED" in qualified_name
    ]


@pytest.mark.parametrize("former", [[], {"boom.messages.FoldBoom": 3}, "x", None])
def test_a_damaged_memory_is_no_obstacle(yard, former):
    path = yard.out / MANIFEST_PATH
    text = path.read_text().replace('"yard": {', f'"yard": {{"former": {json.dumps(former)}, ')
    path.write_text(re.sub(r", \s*\}", "}", text))
    assert read_manifest(yard.out).problem == ""
    assert told(yard.look()) == []


# --------------------------------------------------------------- by the command line


def jausml(*words: object):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.mark.slow
def test_a_component_whose_service_is_gone_fails_the_check(tmp_path):
    """What the skeleton itself imports: an ImportError at the start, and once a green check."""
    model, out = tmp_path / "v.ros2jaus", tmp_path / "ws"
    text = "component vehicle { address: 100.1.1  provides: VelocityStateSensor, LocalPoseSensor }"
    model.write_text(text)
    assert jausml("generate", model, "-o", out, "-q").exit_code == 0
    model.write_text(text.replace(", LocalPoseSensor", ""))
    path = out / "vehicle" / "vehicle" / "vehicle.py"
    written = path.read_text()
    undecided = jausml("generate", model, "-o", out, "--fix")
    assert "--fix changed nothing: how these fit again is for you to decide" in undecided.stderr
    assert path.read_text() == written
    written = re.sub(r"    def on_set_local_pose.*?(?=    def )", "", written, flags=re.DOTALL)
    path.write_text(re.sub(r"\n    def report_local_pose.*", "", written, flags=re.DOTALL))
    assert jausml("generate", model, "-o", out).exit_code == 1
    checked = jausml("generate", model, "-o", out, "--check", "--strict")
    assert checked.exit_code == 1
    line = written.splitlines().index("    QueryLocalPose,") + 1
    said = "vehicle.messages has no QueryLocalPose any more; nothing uses it, take it out"
    assert f"{path}:{line}:5: error: JML905 {said}" in checked.stderr
    assert "--fix changes your files" in checked.stderr
    fixed = jausml("generate", model, "-o", out, "--fix")
    assert f"{path}:{line}: fixed: took out QueryLocalPose," in fixed.stderr
    assert jausml("generate", model, "-o", out, "--check", "--strict").exit_code == 0
    for message in ("QueryLocalPose", "ReportLocalPose", "SetLocalPose"):
        written = written.replace(f"    {message},\n", "")
    assert path.read_text() == re.sub(
        r"\n    def report_local_pose.*", "", written, flags=re.DOTALL
    )


@pytest.mark.slow
def test_a_difference_names_the_lines_that_break(tmp_path):
    old, new, out = tmp_path / "old.ros2jaus", tmp_path / "new.ros2jaus", tmp_path / "ws"
    old.write_text(MODEL)
    assert jausml("generate", old, "-o", out, "-q").exit_code == 0
    path = out / "boom" / "boom" / "boom.py"
    path.write_text(CODE + "\nfrom .messages import GoneBefore\n")
    new.write_text(MODEL.replace("enumerated_value unfolded", "enumerated_value spread"))
    done = jausml("diff", old, new, "--code", out, "--fail-on", "breaking")
    assert done.exit_code == 1
    lines = CODE.splitlines()
    line = next(i for i, code_line in enumerate(lines, 1) if "State.UNFOLDED" in code_line)
    lost = "error: JML906 ReportBoom.State has no UNFOLDED any more; it is SPREAD now"
    assert f"{path}:{line}:41: {lost}\n" in done.stdout
    assert "2 lines of your code to change\n" in done.stdout
    assert "GoneBefore" not in done.stdout
    told = json.loads(jausml("diff", old, new, "--code", out, "--format", "json").stdout)
    assert [finding["line"] for finding in told["code"]] == [line, line + 2]
    assert path.read_text().endswith("GoneBefore\n")
    # The same where the workspace is of the new state.
    assert jausml("generate", new, "-o", out, "-q").exit_code == 1
    assert lost in jausml("diff", old, new, "--code", out).stdout
    none = jausml("diff", old, old, "--code", out)
    assert none.stdout == "no differences\n"


@pytest.mark.parametrize("mode", ["--check", "--diff", "--dry-run"])
def test_fixing_excludes_what_writes_nothing(tmp_path, mode):
    done = jausml("generate", tmp_path / "v.ros2jaus", "--fix", mode)
    assert done.exit_code == 2
    assert f"--fix writes, {mode} does not" in done.stderr
