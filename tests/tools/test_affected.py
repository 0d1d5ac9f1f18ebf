"""What changed decides which tests run, and those nearest to it come first."""

import subprocess
import sys
from pathlib import Path

import pytest
from affected import Checkout, changed_files, guards
from quick import NEAREST
from scripts import succeeded

ROOT = Path(__file__).resolve().parents[2]
FILES = {
    "jausml/__init__.py": "",
    "jausml/words.py": "",
    "jausml/lines.py": "from jausml import words",
    "jausml/pages.py": "from jausml.lines import wrap",
    "jausml/books.py": "from jausml import pages",
    "jausml/shelves.py": "import jausml.books",
    "jausml/alone/__init__.py": "",
    "jausml/alone/templates/page.j2": "",
    "generators/jausml_generators/__init__.py": "",
    "generators/jausml_generators/press.py": "",
    "generators/jausml_generators/templates/sheet.j2": "",
    "tests/test_sheets.py": "from jausml_generators import press",
    "tests/conftest.py": "",
    "tests/paper.py": "from jausml import words",
    "tests/test_lines.py": "from jausml.lines import wrap",
    "tests/test_words.py": "import jausml.words",
    "tests/test_books.py": "from jausml import books",
    "tests/test_shelves.py": "from jausml import shelves",
    "tests/test_paper.py": "from paper import sheet",
    "tests/test_alone.py": "def test():\n    import jausml.alone",
    "jausml/cli/__init__.py": "",
    "jausml/cli/scan.py": "",
    "tests/cli/test_scan.py": "",
    "tests/test_metals.py": 'GUARDS = ("metals", "jausml/words.py")',
    "tests/test_iron.py": 'GUARDS = ("metals/iron.xml",)',
    "tools/press.py": "",
    "tests/tools/test_press.py": "import press",
}
LIST = """\
import sys, pathlib, affected
print(*affected.Checkout(pathlib.Path.cwd()).affected(sys.argv[1:]))
"""


@pytest.fixture
def checkout(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.fixture
def listed(checkout):
    """Names the test files for changed files, in a process that finds the checkout's package."""

    def run(*changed):
        text = f"import sys; sys.path[:0] = ['.', 'generators']\n{LIST}"
        command = [sys.executable, "-c", text, *changed]
        environment = {"PYTHONPATH": str(ROOT / "tools")}
        result = succeeded(command, cwd=checkout, env=environment, timeout=60)
        return [Path(word).relative_to(checkout).as_posix() for word in result.stdout.split()]

    return run


def test_the_nearest_come_first_and_the_far_not_at_all(listed):
    expected = ["test_metals", "test_words", "test_paper", "test_lines", "test_books"]
    assert listed("jausml/words.py") == [f"tests/{name}.py" for name in expected]


def test_a_changed_test_comes_before_all(listed):
    assert listed("jausml/words.py", "tests/test_shelves.py")[0] == "tests/test_shelves.py"


def test_what_guards_a_change_comes_next_the_narrowest_first(listed):
    assert listed("metals/gold.xml") == ["tests/test_metals.py"]
    changed = ("metals/iron.xml", "jausml/words.py", "tests/test_shelves.py")
    expected = ["test_shelves", "test_iron", "test_metals", "test_words"]
    assert listed(*changed)[:4] == [f"tests/{name}.py" for name in expected]
    assert listed("metals_of_others/gold.xml") == []


def test_files_that_tests_import_count_for_them(listed):
    assert listed("tests/paper.py") == ["tests/test_paper.py"]
    assert listed("tools/press.py") == ["tests/tools/test_press.py"]
    assert len(listed("tests/conftest.py")) == 11


def test_what_is_no_module_counts_as_its_package(listed):
    assert listed("jausml/alone/templates/page.j2") == ["tests/test_alone.py"]
    assert listed("generators/jausml_generators/templates/sheet.j2") == ["tests/test_sheets.py"]


def test_what_is_loaded_by_name_is_found_by_name(listed):
    assert listed("jausml/cli/scan.py") == ["tests/cli/test_scan.py"]
    assert listed("models/cli/scan.xmi") == ["tests/cli/test_scan.py"]


def test_what_nothing_imports_needs_no_test(listed):
    assert listed("README.md", "docs/index.md") == []


def test_changed_files_are_those_since_the_branch_left(checkout):
    def git(*arguments):
        names = ("-c", "user.name=a", "-c", "user.email=a@example.org")
        subprocess.run(["git", *names, *arguments], cwd=checkout, check=True, capture_output=True)

    git("init", "--initial-branch=main")
    git("add", ".")
    git("commit", "-m", "start")
    assert changed_files(checkout) == []
    git("switch", "-c", "topic")
    (checkout / "jausml" / "words.py").write_text("a = 1\n", encoding="utf-8")
    git("commit", "-am", "change")
    (checkout / "jausml" / "lines.py").write_text("", encoding="utf-8")
    (checkout / "new ones.py").write_text("", encoding="utf-8")
    assert changed_files(checkout) == ["jausml/lines.py", "jausml/words.py", "new ones.py"]
    assert changed_files(checkout, "HEAD") == ["jausml/lines.py", "new ones.py"]


GUARDED = {
    "jausml/language/attributes/units.py": {"languages/test_units.py"},
    "metamodels/bridge.ecore": {"semantics/test_conversions.py", "metamodel/test_shipped.py"},
    "metamodels/jaus.ecore": {"metamodel/test_classes.py", "emf/test_recorded_verdicts.py"},
    "models/library/mappings/odometry.ros2jaus": {"models/mappings/test_shipped.py"},
    "docs/how-to/extend.md": {"docs/test_named_files.py", "docs/test_commands.py"},
}


def test_what_guards_a_change_of_this_project_is_run():
    checkout = Checkout(ROOT)
    for changed, expected in GUARDED.items():
        near = checkout.affected([changed])[:NEAREST]
        assert expected <= {path.relative_to(ROOT / "tests").as_posix() for path in near}, changed


def test_what_is_guarded_is_there():
    files = {path: guards(path) for path in (ROOT / "tests").rglob("test_*.py")}
    assert sum(map(bool, files.values())) > 15
    lost = [
        (path.name, guarded_path)
        for path in files
        for guarded_path in files[path]
        if not (ROOT / guarded_path).exists()
    ]
    assert lost == []
