"""Workflow, hooks and forms are well formed, and run what is there."""

import ast
import re
from collections import defaultdict
from pathlib import Path

import pytest
import yaml
from for_each import for_each
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from scripts import ran

try:
    import tomllib
except ImportError:  # Python 3.10
    tomllib = None

GUARDS = (".github", ".pre-commit-config.yaml", "Makefile", "pyproject.toml", "requirements")

ROOT = Path(__file__).resolve().parents[2]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
TARGETS = set(re.findall(r"^([a-z][a-z-]*):", MAKEFILE, re.MULTILINE))
FORMS = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))


def read(name):
    return yaml.safe_load((ROOT / name).read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def workflow():
    return read(".github/workflows/ci.yml")


@pytest.mark.parametrize(
    ("file", "wanted"),
    [
        ("ci", {"held", "lint", "coverage", "test-all", "test-random", "audit"}),
        ("release", {"held", "sbom"}),
    ],
)
def test_workflows_run_targets_that_are_there(file, wanted):
    jobs = read(f".github/workflows/{file}.yml")["jobs"]
    steps = [step for job in jobs.values() for step in job["steps"]]
    run = "\n".join(step.get("run", "") for step in steps)
    named = set(re.findall(r"\bmake ([a-z-]+)", run))
    assert wanted <= named <= TARGETS


HELD = re.compile(r"[a-z0-9-]+==\S+( ; [^\\]+)? \\(\n    --hash=sha256:[0-9a-f]{64}( \\)?)+\n")


@pytest.mark.parametrize("name", ["ci", "image", "release"])
def test_what_is_installed_is_held_by_hashes_and_names_no_index(name):
    text = (ROOT / "requirements" / f"{name}.txt").read_text(encoding="utf-8")
    assert HELD.sub("", text) == ""


@pytest.mark.skipif(tomllib is None, reason="needs Python 3.11")
def test_what_is_held_fits_what_is_required():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    required = [*project["dependencies"], *extras["ros"], *extras["dev"], *extras["editor"]]
    text = (ROOT / "requirements" / "ci.txt").read_text(encoding="utf-8")
    held = defaultdict(list)
    for found in re.finditer(r"^([a-z0-9-]+)==(\S+)", text, re.MULTILINE):
        held[found[1]].append(found[2])
    for requirement in map(Requirement, required):
        versions = held[canonicalize_name(requirement.name)]
        assert list(requirement.specifier.filter(versions)), requirement


@pytest.mark.skipif(tomllib is None, reason="needs Python 3.11")
def test_the_workflow_has_the_promised_versions_of_python(workflow):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    promised = re.findall(r"Python :: (3\.\d+)", "\n".join(project["classifiers"]))
    assert workflow["jobs"]["check"]["strategy"]["matrix"]["python"] == promised


def test_hooks_run_what_lint_runs():
    hooks = [hook for repo in read(".pre-commit-config.yaml")["repos"] for hook in repo["hooks"]]
    lint = re.search(r"^lint:.*\n((?:\t.*\n)+)", MAKEFILE, re.MULTILINE)[1]
    programs = set(re.findall(r"\$\(BIN\)/([a-z-]+)", lint))
    assert {hook["entry"].split()[0] for hook in hooks} == {f".venv/bin/{p}" for p in programs}
    assert all(hook["language"] == "system" for hook in hooks)


@pytest.mark.parametrize("form", FORMS, ids=lambda path: path.stem)
def test_forms_are_yaml(form):
    content = read(form.relative_to(ROOT))
    assert form.name == "config.yml" or {"name", "description", "body"} <= content.keys()


@pytest.mark.parametrize(
    "page", ["CONTRIBUTING.md", ".github/pull_request_template.md", "docs/how-to/extend.md"]
)
def test_pages_name_targets_that_are_there(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    named = set(re.findall(r"`make ([a-z-]+)", text))
    assert named
    assert named <= TARGETS


def test_help_says_what_each_target_does():
    said = ran(["make", "--no-print-directory", "help"], cwd=ROOT).stdout
    assert {line.split()[0] for line in said.splitlines()} == TARGETS


HIDING = {"each", "found", "told", "made", "given", "ways", "stays", *"efmorstuv"}
"""They hide the noun: a loop over services has `service`, what was found are `services`."""
BINDING = re.compile(
    rf"(?<![\w.])(?:{'|'.join(sorted(HIDING))})(?:\s*[=:,)\]]|\s+in\b|\s*$)", re.MULTILINE
)
"""What a text has where it may give such a name to something: to parse all takes long."""


def hiding(tree: ast.AST) -> set[tuple[int, str]]:
    """The lines and names of variables and parameters in functions that say nothing.

    Attributes of classes are left out: some are named as features of the metamodels are.
    """
    nodes = (
        node
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        for node in ast.walk(function)
    )
    names = {
        (node.lineno, node.arg if isinstance(node, ast.arg) else node.id)
        for node in nodes
        if isinstance(node, ast.arg | ast.Name)
    }
    return {(line, name) for line, name in names if name in HIDING}


@pytest.mark.parametrize("folder", ["jausml", "generators", "tools", "benchmarks", "experiments"])
def test_variables_are_called_by_what_they_are(folder):
    hidden = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        if BINDING.search(text := path.read_text(encoding="utf-8"))
        for line, name in sorted(hiding(ast.parse(text)))
    ]
    assert hidden == []


@pytest.mark.parametrize(
    ("code", "name"),
    [("def f():\n return [each for each in []]", "each"), ("lambda found: 1", "found")],
)
def test_a_hidden_noun_is_found(code, name):
    assert {hidden for _, hidden in hiding(ast.parse(code))} == {name}


ORDER = re.compile(
    r'^ +"""(?:Add|Ask|Call|Drop|End|Give|Let|Make|Remove|Return|Run|Send|Start|Take|Tell|Yield) ',
    re.MULTILINE,
)
"""How a docstring would order what its function is to do. Help of commands does, for users."""


@for_each("folder", ["jausml", "generators", "tools", "benchmarks"])
def test_docstrings_say_what_functions_do(folder):
    orders = [
        f"{path.relative_to(ROOT)}: {order[0].strip()}"
        for path in sorted((ROOT / folder).rglob("*.py"))
        if not path.is_relative_to(ROOT / "jausml" / "cli")
        for order in ORDER.finditer(path.read_text(encoding="utf-8"))
    ]
    assert orders == []


def test_an_order_is_found():
    assert ORDER.search('def f():\n    """Return it."""\n')
    assert not ORDER.search('def f():\n    """Returns it."""\n')
