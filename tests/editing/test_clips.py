"""What is pasted is any text: it is read and judged, and never fails otherwise."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.project import Project

HOME = "boat.ros2jaus"
BOAT = """system boat {
    component helm { address: 100.1.1  provides: VelocityStateDriver }
}
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    folder = tmp_path_factory.mktemp("project")
    (folder / HOME).write_text(BOAT, encoding="utf-8")
    return Project(folder)


words = st.sampled_from(
    (*("bridge", "component", "node", "nav", "{", "}", ":", "map", "provides", "helm", "\n", "->"),
     *("import", "JAUS", "root", "new", '"', "/**", "*/", "address", "100.1.1", "connection", ",")),
)  # fmt: skip


@settings(max_examples=100, deadline=None)
@given(text=st.lists(words, max_size=12).map(" ".join) | st.text(max_size=30))
def test_any_text_is_pasted_or_refused(project, text):
    before = project.text(HOME)
    try:
        clip = project.clip(text, f"{HOME}#/")
        project.paste(clip.commands, f"{HOME}#/", "paste")
    except EditError:
        assert project.text(HOME) == before
        return
    project.undo()
    assert project.text(HOME) == before


def test_text_of_an_editor_is_pasted_as_it_stands_in_its_owner(project):
    text = "node mast { publisher light { topic: light  type: std_msgs/Bool } }"
    clip = project.clip(text, f"{HOME}#/")
    entry = project.paste(clip.commands, f"{HOME}#/", "paste")
    assert project.find(entry.created[0])[0].publishers[0].topic == "light"
    project.undo()


def test_what_leads_to_nothing_is_left_out_and_asked_of_a_person(project):
    text = """bridge nav {
    address: 100.1.2
    provides: Winch
    connection drive { map: gone_map  direction: jausToRos  peers: helm, nobody  topic cmd }
}"""
    clip = project.clip(text, f"{HOME}#/")
    assert [omission.name for omission in clip.left_out] == ["nav", "drive", "drive"]
    made = project.find(project.paste(clip.commands, f"{HOME}#/", "paste").created[0])[0]
    [drive] = made.bridgeConnections
    assert [peer.name for peer in drive.peers] == ["helm"]
    asked = [open_decision.text for open_decision in drive.openDecisions]
    assert len(asked) == 2
    assert "gone_map" in asked[0] + asked[1]
    project.undo()


def test_files_outside_are_not_read(project, tmp_path):
    secret = tmp_path / "secret.ros2jaus"
    secret.write_text("component hidden { address: 1.1.1 }\n", encoding="utf-8")
    text = f'import "{secret}"\ncomponent spy {{ controls: hidden }}'
    clip = project.clip(text, f"{HOME}#/")
    assert [omission.name for omission in clip.left_out] == ["spy"]
