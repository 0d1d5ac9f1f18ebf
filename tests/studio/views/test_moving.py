"""Lines in the views of machines and services: what they add, and that the rules take it."""

from pathlib import Path

import pytest
from scope_support import EditedFile

from jausml.authoring.editing.commands import Add, Remove, Rename
from jausml.authoring.studio.views.forms import choices, form_of
from jausml.authoring.studio.views.palette import palette
from jausml.authoring.studio.views.service_lines import cut, heritage, join, lead
from jausml.language.metamodel.classes import jaus
from jausml.language.model.library import LIBRARY_URI
from jausml.language.project import library
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.validation.engine import check
from jausml.views.diagrams.views import graph_of

WINCH = Path(__file__).parents[3] / "models" / "examples" / "winch" / "service.xmi"
FILE = "service.xmi"
READY = "Receiving.Ready.Controlled.Available.Ready"


class Editor(EditedFile):
    """The service of the winch, and its two views."""

    def __init__(self, folder):
        text = WINCH.read_text(encoding="utf-8").replace("../../library/", LIBRARY_URI)
        (folder / FILE).write_text(text, encoding="utf-8")
        super().__init__(folder, FILE)

    def the(self, kind):
        [found] = self.scope.model.instances(kind, library=False)
        return found

    def graph(self, view):
        return graph_of(self.scope.model, view, root=self.project.root)

    def box(self, path):
        [found] = [e for e in self.graph("machine:ReceiveFSM").nodes if e.id.endswith(f"!{path}")]
        return found.id

    def lead(self, source, target):
        return lead(self.scope, self.the(jaus.StateMachine), self.box(source), self.box(target))

    def take(self, option):
        super().take(option)
        found = check(self.project.model(FILE)).diagnostics
        assert [diagnostic for diagnostic in found if diagnostic.severity.value == "error"] == []


@pytest.fixture
def editor(tmp_path):
    return Editor(tmp_path)


def test_a_line_between_states_offers_what_may_trigger_a_transition(editor):
    found = editor.lead(f"{READY}.Locked", f"{READY}.Moving.PayingIn")
    labels = [option.label for option in found.options]
    assert labels[0] == "transition on LockBrake"
    assert {
        "transition on EndStop",
        "transition on LoadLost",
        "transition on Timedout",
        "transition on anything else",
    } <= set(labels)
    assert {"transition on SetWinchCommand (again)", "transition on ReleaseBrake (again)"} == set(
        labels[-2:]
    )
    first = next(option for option in found.options if "SetWinchCommand" in option.label)
    [added] = first.commands
    assert added.values["target"] == ("Moving.PayingIn",)
    assert added.values["guard"] == ("isControllingClient",)
    editor.take(first)
    edges = editor.graph("machine:ReceiveFSM").edges
    ends = {(edge.source.node, edge.target.node) for edge in edges}
    assert (editor.box(f"{READY}.Locked"), editor.box(f"{READY}.Moving.PayingIn")) in ends


def test_what_the_rules_reject_at_once_triggers_nothing(editor):
    found = editor.lead(f"{READY}.Locked", f"{READY}.Moving.PayingIn")
    transition = editor.scope.model.instances(jaus.Transition, library=False)[0]
    offered = choices(editor.scope, editor.scope.ref(transition), "message")
    labels = {option.label.removeprefix("transition on ") for option in found.options}
    labels |= {choice.label.rpartition(".")[2] for choice in offered.choices}
    assert "LockBrake" in labels
    served = (s for s in library().instances(jaus.Service) if s.urn in SERVED_BY_RUNTIME)
    assert not labels & {message.name for service in served for message in service.inputs}


def test_a_machine_gets_a_new_internal_event_of_its_service(editor):
    machine, service = editor.the(jaus.StateMachine), editor.the(jaus.Service)
    for onto in (machine, next(iter(machine.states))):
        items = palette(editor.scope, "event", onto=editor.scope.ref(onto))
        [item] = [item for item in items if item.label == "internal event"]
        [add] = item.commands
        assert (add.owner, add.feature) == (editor.scope.ref(service), "events")
    editor.project.do(item.commands, item.label_of_edit)
    found = editor.lead(f"{READY}.Locked", f"{READY}.Idle")
    assert "transition on Event" in [option.label for option in found.options]


def test_a_state_that_the_machine_only_extends_is_added_with_its_transition(editor):
    machine = editor.the(jaus.StateMachine)
    core = f"{editor.scope.model.fragment(machine)}!Receiving.Ready.NotControlled"
    found = lead(editor.scope, machine, core, editor.box(READY))
    [added] = next(
        option for option in found.options if option.label == "transition on EndStop"
    ).commands
    assert added.values == {"name": ("Receiving.Ready.NotControlled",)}


def test_a_composite_state_gets_what_holds_in_all_states_inside(editor):
    [found] = [
        e
        for e in editor.lead(READY, f"{READY}.Idle").options
        if e.label == "transition on ReleaseBrake"
    ]
    assert found.commands[0].feature == "defaults"
    editor.take(found)


def test_services_of_the_library_are_read_only(editor):
    base = next(
        service for service in library().instances(jaus.Service) if service.inherits is not None
    )
    ref = editor.scope.ref(base)
    assert "library" in join(editor.scope, (ref, ""), (ref, "")).refusal


def test_the_form_of_a_transition_knows_its_states_and_events(editor):
    transition = next(e for e in editor.scope.model.instances(jaus.Transition) if e.target)
    fields = {field.feature: field for field in form_of(editor.scope, transition).fields}
    assert "Locked" in [choice.value for choice in fields["target"].choices]
    assert {"EndStop", "Timedout"} <= {choice.value for choice in fields["event"].choices}


def test_a_machine_that_is_made_by_clicks_alone_has_no_error(editor):
    def add(owner, name):
        children = {child.feature: child for child in form_of(editor.scope, owner).children}
        [kind] = children[name].kinds
        add = Add(editor.scope.ref(owner), name, kind.kind, kind.values)
        editor.project.do([add], "add")

    editor.project.do([Remove(editor.scope.ref(editor.the(jaus.StateMachine)))], "remove")
    add(editor.the(jaus.Service), "inputs")
    add(editor.the(jaus.Service), "outputs")
    names = [
        message.name for message in editor.scope.model.instances(jaus.MessageDef, library=False)
    ]
    assert {"Message", "Message2"} <= set(names)
    add(editor.the(jaus.Service), "machines")
    assert editor.the(jaus.StateMachine).name == "ReceiveFSM"
    add(editor.the(jaus.StateMachine), "states")
    add(editor.the(jaus.State), "states")
    add(editor.the(jaus.StateMachine).states[0], "states")
    found = check(editor.project.model(FILE)).diagnostics
    assert [diagnostic for diagnostic in found if diagnostic.severity.value == "error"] == []


def test_transitions_are_called_by_what_triggers_them_and_where_they_lead(editor):
    states = editor.scope.model.instances(jaus.State, library=False)
    locked = next(state for state in states if state.name == "Locked")
    held = {child.feature: child.elements for child in form_of(editor.scope, locked).children}
    labels = [child.label for child in held["transitions"]]
    assert labels == ["ReleaseBrake to Idle", "SetWinchCommand"]


def test_a_service_comes_to_inherit_another_one_and_no_longer_does(editor):
    own = editor.scope.model.fragment(editor.the(jaus.Service))
    bases = {choice.label: choice.value for choice in heritage(editor.scope, own)}
    assert "Winch" not in bases
    events = next(value for label, value in bases.items() if label.startswith("Events"))
    [option] = join(editor.scope, (own, ""), (events, "")).options
    assert "instead of Management" in option.why
    editor.project.do(option.commands, option.label)
    assert editor.the(jaus.Service).inherits.name == "Events"
    [option] = cut(editor.scope, f"{own}!inherits").options
    editor.project.do(option.commands, option.label)
    assert editor.the(jaus.Service).inherits is None
    assert "follows" in cut(editor.scope, f"{own}!takes!edge").refusal


def test_a_query_gets_its_report_and_a_report_its_query(editor):
    service = editor.the(jaus.Service)
    [children] = [
        child for child in form_of(editor.scope, service).children if child.feature == "inputs"
    ]
    values = children.kinds[0].values
    assert values == {"name": ("Message",), "code": ("0xD000",)}
    rows = {
        port.label: (node.id, port.id)
        for node in editor.graph("service:Winch").nodes
        for port in node.ports
    }
    answered = join(editor.scope, rows["QueryWinchState"], ("", ""))
    assert "already" in answered.refusal
    assert "neither" in join(editor.scope, rows["LockBrake"], ("", "")).refusal
    messages = editor.scope.model.instances(jaus.MessageDef, library=False)
    report = next(message for message in messages if message.name == "ReportWinchState")
    editor.project.do([Rename(editor.scope.ref(report), "ReportOther")], "rename")
    rows = {p.label: (n.id, p.id) for n in editor.graph("service:Winch").nodes for p in n.ports}
    [option] = join(editor.scope, rows["QueryWinchState"], ("", "")).options
    assert option.commands[0].values == {"name": ("ReportWinchState",), "code": ("0xD000",)}
    editor.take(option)
