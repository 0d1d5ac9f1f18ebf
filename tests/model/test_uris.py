"""Where hrefs may lead: relative files, file: and platform: URIs, the library; nothing else."""

import os
import shutil
import socket

import pytest
from reader_support import ZOO_METAMODELS, zoo

from jausml.language.metamodel.classes import jaus
from jausml.language.model import LIBRARY_URI, find_project_root, library_root, read_models

LIBRARY_MODEL = f"""<jaus:Component xmlns:jaus="http://www.jausml.org/jaus/1.0" name="c"
    address="1.1.1"><provides href="{LIBRARY_URI}jaus/core-1.1.xmi#//@services.0"/></jaus:Component>
"""


def rules(result):
    return [diagnostic.rule for diagnostic in result.diagnostics]


@pytest.fixture
def lib(documents):
    return documents.write("parts/lib.xmi", zoo('<cages id="x"/>', 'name="Lib"'))


@pytest.mark.parametrize(
    "href",
    [
        "parts/lib.xmi#x",
        "./parts//lib.xmi#x",
        "nowhere/../parts/lib.xmi#x",
        "file:parts/lib.xmi#x",
        "{file}#x",
        "file://localhost{path}#x",
        "{path}#x",
        "platform:/resource/parts/lib.xmi#x",
        "platform:/resource/mapped/lib.xmi#x",
        "platform:/resource/{root}/parts/lib.xmi#x",
        "platform:/resource/p%61rts/lib.xmi#x",
    ],
)
def test_ways_to_name_a_file(documents, lib, href):
    href = href.format(file=lib.as_uri(), path=lib, root=documents.folder.name)
    result = documents.one(
        zoo(f'<main href="{href}"/>'), projects={"mapped": documents.folder / "parts"}
    )
    assert result.diagnostics == []
    assert result.model.root.main.id == "x"
    assert len(result.model.documents) == 2


def test_one_file_by_several_names_is_one_document(documents, lib):
    link = documents.folder / "link.xmi"
    link.symlink_to(lib)
    body = (
        '<main href="link.xmi#x"/>'
        '<cages id="q"><neighbours href="parts/lib.xmi#x"/>'
        f'<neighbours href="{lib}#//@cages.0"/></cages>'
    )
    result = documents.one(zoo(body))
    assert rules(result) == ["JML213"], "both neighbours are the same cage"
    assert len(result.model.documents) == 2


@pytest.mark.parametrize(
    ("href", "rule"),
    [
        ("http://www.example.org/x.xmi#/", "JML208"),
        ("HTTPS://www.example.org/x.xmi#/", "JML208"),
        ("ftp://www.example.org/x.xmi#/", "JML208"),
        ("file://server/share/x.xmi#/", "JML208"),
        ("/etc/passwd#/", "JML209"),
        ("file:///etc/passwd#/", "JML209"),
        ("../../../../../../../../etc/passwd#/", "JML209"),
        ("%2e%2e/%2e%2e/%2e%2e/x.xmi#/", "JML209"),
        ("platform:/resource/../../../x.xmi#/", "JML209"),
        ("platform:/resource/elsewhere/x.xmi#/", "JML210"),
        ("platform:/plugin/org.example/x.xmi#/", "JML211"),
        ("pathmap://X/x.xmi#/", "JML211"),
        ("C:/models/x.xmi#/", "JML211"),
        ("parts\\lib.xmi#/", "JML211"),
        ("a%00b.xmi#/", "JML211"),
        ("file://[::1/x.xmi#/", "JML211"),
        ("absent.xmi#/", "JML203"),
        (f"{'n' * 5000}.xmi#/", "JML203"),
        (f"platform:/resource/{'n' * 5000}/x#/", "JML210"),
        (f"{LIBRARY_URI}jaus/core-1.2.xmi#/", "JML212"),
        (f"{LIBRARY_URI}../../../x.xmi#/", "JML212"),
        (f"{LIBRARY_URI}{'n' * 5000}#/", "JML212"),
        ("parts#/", "JML203"),
    ],
)
@pytest.mark.usefixtures("lib")
def test_refused(documents, monkeypatch, href, rule):
    def no_network(*_):
        raise AssertionError("the network was used")

    monkeypatch.setattr(socket, "socket", no_network)
    assert rules(documents.one(zoo(f'<main href="{href}"/>'))) == [rule]


def test_outside_is_allowed_when_asked(documents, lib):
    text = zoo(f'<main href="{lib}#x"/>')
    elsewhere = documents.folder / "other"
    elsewhere.mkdir()
    assert rules(documents.one(text, project_root=elsewhere)) == ["JML209"]
    assert rules(documents.one(text, project_root=elsewhere, allow_outside=True)) == []


def test_links_do_not_lead_outside(documents, tmp_path_factory):
    secret = tmp_path_factory.mktemp("outside") / "secret.xmi"
    secret.write_text(zoo(), encoding="utf-8")
    (documents.folder / "inside.xmi").symlink_to(secret)
    assert rules(documents.one(zoo('<branches href="inside.xmi#/"/>'))) == ["JML209"]


def test_given_files_may_be_referred_to(documents, tmp_path_factory):
    far = tmp_path_factory.mktemp("far") / "far.xmi"
    far.write_text(zoo('<cages id="far"/>'), encoding="utf-8")
    documents.write("model.xmi", zoo(f'<main href="{far.as_uri()}#far"/>'))
    assert rules(documents.read("model.xmi")) == ["JML209"]
    assert rules(documents.read("model.xmi", far)) == []


def test_library_needs_no_network(documents):
    documents.write("c.xmi", LIBRARY_MODEL)
    result = documents.read("c.xmi", metamodels=None)
    assert result.diagnostics == []
    (service,) = result.model.root.provides
    assert result.model.is_library(service)
    assert not result.model.is_library(result.model.root)
    assert result.model.instances(jaus.Service, library=False) == []
    assert service in result.model.instances(jaus.Service)


def test_library_by_relative_href(documents):
    path = os.path.relpath(library_root() / "jaus" / "core-1.1.xmi", documents.folder)
    documents.write("c.xmi", LIBRARY_MODEL.replace(f"{LIBRARY_URI}jaus/core-1.1.xmi", path))
    result = documents.read("c.xmi", metamodels=None)
    assert result.diagnostics == []
    assert result.model.is_library(result.model.root.provides[0])


def test_library_suggestion(documents):
    documents.write("c.xmi", LIBRARY_MODEL.replace("core-1.1", "core-1.7"))
    (finding,) = documents.read("c.xmi", metamodels=None).diagnostics
    assert "jaus/core-1." in finding.hint


def test_shipped_library_reads_clean():
    paths = sorted(library_root().rglob("*.xmi"))
    assert paths
    result = read_models(paths)
    assert [str(diagnostic) for diagnostic in result.diagnostics] == []
    assert all(document.is_library for document in result.model.documents)


def test_project_root_is_the_checkout(tmp_path):
    model = tmp_path / "repository" / "models" / "a.xmi"
    (tmp_path / "repository" / ".git").mkdir(parents=True)
    assert find_project_root([model]) == tmp_path / "repository"


def test_project_root_without_checkout(tmp_path, monkeypatch):
    one, other = tmp_path / "a" / "x.xmi", tmp_path / "b" / "y.xmi"
    (tmp_path / "a").mkdir()
    monkeypatch.chdir(tmp_path)
    assert find_project_root([one, other]) == tmp_path
    monkeypatch.chdir(tmp_path / "a")
    assert find_project_root([one]) == tmp_path / "a"
    assert find_project_root([one, other]) == tmp_path
    assert find_project_root([]) == tmp_path / "a"
    shutil.rmtree(tmp_path / "a")


PROJECT = "<projectDescription><name>{}</name></projectDescription>"


@pytest.fixture
def workspace(tmp_path):
    """Two Eclipse projects side by side; the folder of one has another name than the project."""
    for folder, name in (("robot", "robot.model"), ("shared folder", "robot.library")):
        (tmp_path / folder / "model").mkdir(parents=True)
        (tmp_path / folder / ".project").write_text(PROJECT.format(name), encoding="utf-8")
    (tmp_path / "shared folder" / "model" / "lib.xmi").write_text(zoo('<cages id="far"/>'))
    (tmp_path / "secret.xmi").write_text(zoo('<cages id="far"/>'))
    return tmp_path


def zoo_model(path, **options):
    """Reads a model without saying where its project is."""
    return read_models([path], metamodels=ZOO_METAMODELS, **options)


@pytest.mark.parametrize("here", [".", "robot", "robot/model", "shared folder"])
@pytest.mark.parametrize(
    ("href", "expected"),
    [
        ("platform:/resource/robot.library/model/lib.xmi#far", []),
        ("../../shared%20folder/model/lib.xmi#far", []),
        ("platform:/resource/elsewhere/model/lib.xmi#far", ["JML210"]),
        ("../../secret.xmi#far", ["JML209"]),
    ],
)
def test_eclipse_projects_are_found_wherever_one_stands(
    workspace, monkeypatch, here, href, expected
):
    model = workspace / "robot" / "model" / "robot.xmi"
    model.write_text(zoo(f'<main href="{href}"/>'), encoding="utf-8")
    monkeypatch.chdir(workspace / here)
    assert rules(zoo_model(os.path.relpath(model))) == expected


def test_a_project_that_is_elsewhere_is_named(workspace, tmp_path_factory):
    far = tmp_path_factory.mktemp("far")
    (far / "lib.xmi").write_text(zoo('<cages id="far"/>'), encoding="utf-8")
    model = workspace / "robot" / "model" / "robot.xmi"
    text = zoo('<main href="platform:/resource/elsewhere/lib.xmi#far"/>')
    model.write_text(text, encoding="utf-8")
    assert rules(zoo_model(model)) == ["JML210"]
    assert rules(zoo_model(model, projects={"elsewhere": far})) == []


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\xff\xfe",
        b"<projectDescription/>",
        b"<other><name>robot.library</name></other>",
        b'<!DOCTYPE p [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
        b"<projectDescription><name>&x;</name></projectDescription>",
    ],
)
def test_a_project_file_that_says_nothing_is_no_project(workspace, content):
    (workspace / "shared folder" / ".project").write_bytes(content)
    model = workspace / "robot" / "model" / "robot.xmi"
    text = zoo('<main href="platform:/resource/robot.library/model/lib.xmi#far"/>')
    model.write_text(text, encoding="utf-8")
    assert rules(zoo_model(model)) == ["JML210"]
