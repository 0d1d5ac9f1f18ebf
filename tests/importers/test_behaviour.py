"""State machines of JSIDL, and what of them a model cannot say."""

import pytest
from for_each import for_each
from jsidl_support import good, marked, run, service, winch

RECEIVE = '<parameter type="{}" value="msg"/>'
MACHINE = '<start state_machine_name="M" state_name="{start}"/><state_machine name="a.b.M">{states}'
MACHINE += "</state_machine>"


def machine(states, start="S"):
    return service(behaviour=MACHINE.format(start=start, states=states))


def state(content="", name="S", initial=""):
    first = f' initial_state="{initial}"' if initial else ""
    return f'<state name="{name}"{first}>{content}</state>'


def on(message, content, name="a.transport.Receive"):
    parameter = RECEIVE.format(message) if message else ""
    return f'<transition name="{name}">{parameter}{content}</transition>'


def only(made):
    """Returns the only transition of the only state."""
    return made.machines[0].states[0].transitions[0]


def test_the_machine_of_the_winch():
    (drum,) = winch().sets[0].services[0].machines
    assert drum.name == "Drum"
    pairs = [(machine_state.name, machine_state.initial) for machine_state in drum.states]
    assert pairs == [("Idle", True), ("Moving", False), ("Stopped", False)]
    idle, moving, stopped = drum.states
    assert [action.name for action in (*idle.entry, *idle.exit)] == ["brake", "release"]
    first, second, third = idle.transitions
    assert (first.message.name, first.target) == ("SetRope", "Moving.PayingOut")
    assert first.guard == "isControllingClient(transportData) && !isJammed"
    assert (second.kind.name, second.guard) == ("internal", "guard_length_3")
    assert "Guard: length > 3" in second.documentation
    (reject,) = second.actions
    assert (reject.name, reject.sends.name) == ("makeRejectRopeTooLong", "RejectRope")
    assert (third.message.name, third.actions[0].name) == ("QueryRope", "ReportRope")
    assert [machine_state.initial for machine_state in moving.states] == [True, False]
    assert moving.defaults[0].message.name == "StopWinch"
    assert moving.states[0].transitions[0].kind.name == "push"
    jammed, overload, other = stopped.transitions[:3]
    assert (jammed.event, jammed.actions[0].name) == ("Jammed", "sendRejectRope")
    assert jammed.actions[0].sends is None
    assert overload.kind.name == "pop"
    assert (other.message, other.event) == (None, None)


def test_a_message_that_the_service_does_not_take_is_suggested():
    text = machine(state(on("QueryLamb", "<new:internal/>")))
    (found,) = marked(text.replace("type=", "⟦JML622⟧type="))
    assert found.hint == "did you mean 'QueryLamp'?"


def test_an_event_that_is_not_known_is_suggested():
    text = machine(state(on("", "<new:internal/>", "own.Burn")))
    (found,) = marked(text.replace('name="own.Burn"', '⟦JML622⟧name="own.Burn"'))
    assert found.hint == "did you mean 'Burnt'?"


def test_events_of_the_core_are_known():
    assert only(good(machine(state(on("", "<new:internal/>", "x.Timedout"))))).event == "Timedout"


def test_a_target_that_is_no_state_is_left_out():
    text = machine(state(on("SetLamp", '<simple><end_state state="Of"/></simple>'), "Off"), "Off")
    (found,) = marked(text.replace("<transition", "⟦JML622⟧<transition"))
    assert found.hint == "did you mean 'Off'?"


def test_a_group_without_a_first_state():
    text = machine(state("⟦JML625⟧" + state(name="A") + state(name="B")))
    marked(text)
    made = good(machine(state(state(name="A") + state(name="B")), "S.B"))
    initials = [machine_state.initial for machine_state in made.machines[0].states[0].states]
    assert initials == [False, True]


def test_start_and_initial_state_may_differ():
    inner = state(name="A") + state(name="B")
    text = machine(state(inner, initial="A"), "S.B")
    marked(text.replace("initial_state", "⟦JML624⟧initial_state"))


@for_each(
    "content",
    [
        '<push><end_state state="S"/>⟦JML624⟧<simple/></push>',
        '<pop ⟦JML624⟧transition="Next"/>',
        '<pop>⟦JML624⟧<argument value="x"/></pop>',
        "<simple/>⟦JML602⟧<new:internal/>",
    ],
)
def test_what_a_model_cannot_say_is_said(content):
    marked(machine(state(on("SetLamp", content))))


def test_a_transition_needs_a_kind():
    marked(machine(state(on("SetLamp", "")).replace("<transition", "⟦JML604⟧<transition")))


@pytest.mark.parametrize(
    ("arguments", "name", "sends"),
    [
        (("'ReportLamp'", "transportData"), "ReportLamp", "ReportLamp"),
        (("'ReportLamp'", "'LOW_POWER'", "transportData"), "ReportLampLowPower", "ReportLamp"),
        (("msg", "transportData"), "sendMsg", None),
    ],
)
def test_actions_that_send(arguments, name, sends):
    written = "".join(f'<argument value=" {argument} "/>' for argument in arguments)
    action = f'<new:internal/><action name="a.transport.Send">{written}</action>'
    (made,) = only(good(machine(state(on("QueryLamp", action))))).actions
    assert (made.name, made.sends.name if made.sends else None) == (name, sends)
    assert list(made.arguments) == list(arguments)


def test_a_parameter_that_is_a_part_of_an_event_is_told_to_be_the_event():
    told = marked(
        machine(
            state(
                '<transition name="Burnt">⟦JML626⟧<parameter type="Burnt" value="msg"/>'
                '<parameter ⟦JML624⟧type="Burnt.Body.Colour.Red" value="red"/><new:internal/>'
                "</transition>"
            )
        )
    )
    assert told[1].message == "'red' is taken for the event, not for 'Burnt.Body.Colour.Red'"


def test_an_unknown_message_to_send_is_suggested():
    action = (
        '<new:internal/>⟦JML624⟧<action name="t.Send"><argument value="\'ReportLam\'"/></action>'
    )
    (found,) = marked(machine(state(on("QueryLamp", action))))
    assert found.hint == "did you mean 'ReportLamp'?"


def test_equal_texts_are_equal_guards_and_others_are_not():
    def guarded(text):
        return on("SetLamp", f'<guard condition="{text}"/><new:internal/>')

    content = guarded("a > 3") + guarded("a &lt; 3") + guarded("a  > 3")
    text = machine(state(content.replace("condition", "⟦JML623⟧condition")))
    from jsidl_support import MARKER, run

    assert len(marked(text)) == 3
    made = run(MARKER.sub("", text)).sets[0].services[0].machines[0].states[0]
    guards = [transition.guard for transition in made.transitions]
    assert guards == ["guard_a_3", "guard_a_3_2", "guard_a_3"]


def test_machines_can_be_left_out():
    made = good(machine(state(on("QueryLamb", "<new:internal/>"))), behaviour=False)
    assert list(made.machines) == []
    assert [event.name for event in made.events] == ["Burnt"]


INHERITS = """<references>
    <inherits_from name="management" id="urn:jaus:jss:core:Management" version="1.1"/>
  </references>"""


def test_a_transition_on_what_the_runtime_takes_is_left_out():
    """It would never be taken, and warned about at each check (JML350)."""
    states = state(on("a.management.Standby", "<simple/>") + on("SetLamp", "<internal/>"))
    text = service(references=INHERITS, behaviour=MACHINE.format(start="S", states=states))
    made = run(text)
    transitions = made.sets[0].services[0].machines[0].states[0].transitions
    assert [transition.message.name for transition in transitions] == ["SetLamp"]
    assert [
        (finding.rule, finding.message) for finding in made.diagnostics if finding.rule == "JML624"
    ] == [("JML624", "Standby is taken by Management of the runtime, not by a transition")]


ENTRY = '<entry><action name="startMotor"/></entry>'
STAYS = "⟦JML629⟧" + on("QueryLamp", "<simple/>")


@pytest.mark.parametrize(
    "states",
    [
        state(ENTRY + STAYS),
        state(STAYS + state(ENTRY, name="Inside"), initial="Inside"),
        state(ENTRY) + f"<default_state>{STAYS}</default_state>",
    ],
)
def test_a_transition_that_stays_beside_entry_actions_is_told(states):
    (told,) = marked(machine(states))
    assert told.severity.name == "INFO"


@pytest.mark.parametrize(
    "states",
    [
        state(on("QueryLamp", "<simple/>")),
        state(ENTRY + on("QueryLamp", '<simple><end_state state="S"/></simple>')),
        state(ENTRY + on("QueryLamp", "<new:internal/>")),
    ],
)
def test_a_transition_without_doubt_is_not_told(states):
    good(machine(states))


def test_a_stateless_behaviour_that_says_nothing_is_no_machine():
    def stateless(content):
        text = machine(state(content))
        return text.replace("<protocol_behavior>", '<protocol_behavior is_stateless="true">')

    assert list(good(stateless("")).machines) == []
    assert len(good(stateless(on("SetLamp", "<new:internal/>"))).machines) == 1
    assert len(good(machine(state())).machines) == 1
