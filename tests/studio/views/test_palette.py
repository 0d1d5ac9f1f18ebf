"""The palette: what is found, and what adds it."""

from for_each import for_each
from scope_support import CAR, SHIPPED, named, scope_of

from jausml.authoring.editing.commands import Add, Set
from jausml.authoring.studio.views.palette import palette
from jausml.language.metamodel.classes import bridge, jaus, ros


def labels(found, group=None):
    return [entry.label for entry in found if group in (None, entry.group)]


def test_words_of_names_find_services_types_and_maps():
    scope = scope_of(CAR)
    assert "VelocityStateSensor" in labels(palette(scope, "velocity sensor"), "components")
    assert labels(palette(scope, "nav odometry"), "ros types")[0] == "nav_msgs/Odometry"
    assert "velocity_command" in labels(palette(scope, "twist"), "ready maps")
    assert palette(scope, "qwertz") == []


def test_the_nearest_name_comes_first():
    found = palette(scope_of(CAR), "geometry_msgs/twist", kinds=["ros types"])
    assert found[0].label == "geometry_msgs/Twist"


def test_what_only_mentions_a_name_is_left_out_where_something_has_it():
    scope = scope_of(CAR)
    onto = named(scope, bridge.Bridge, "catvehicle.bridge")
    assert labels(palette(scope, "node", onto=onto)) == ["node"]
    assert "health" in labels(palette(scope, "diagnostic_aggregator", onto=onto))


def test_elements_are_not_found_by_the_name_of_their_owner_but_those_of_the_bridge_are():
    scope = scope_of(CAR)
    onto = named(scope, jaus.Component, "catvehicle.vehicle")
    assert "service connection" not in labels(palette(scope, "vehicle", onto=onto))
    assert "attribute map" in labels(palette(scope, "attribute map"))


def test_kinds_and_limits_are_kept():
    scope = scope_of(CAR)
    found = palette(scope, "", kinds=["elements"])
    assert {palette_item.group for palette_item in found} == {"elements"}
    assert {"component", "bridge", "node", "host"} <= set(labels(found))
    assert labels(found).count("bridge") == 1
    assert len(palette(scope, "", limit=7)) == 7
    ids = [palette_item.id for palette_item in palette(scope, "", limit=10_000)]
    assert len(ids) > 300


def test_a_component_gets_a_free_name_and_address():
    scope = scope_of(CAR)
    [item] = [e for e in palette(scope, "component", ["elements"]) if e.label == "component"]
    [add] = item.commands
    assert isinstance(add, Add)
    assert (add.kind, add.feature) == ("jaus.Component", "components")
    assert scope.find(add.owner) is scope.model.root
    taken = {component.address for component in scope.model.instances(jaus.Component)}
    assert add.values["address"][0] not in taken
    assert add.values["address"][0].startswith("100.1.")


def test_what_is_dropped_on_a_node_becomes_an_end_of_it():
    scope = scope_of(CAR)
    onto = named(scope, ros.Node, "catvehicle.logger")
    [publisher, subscription] = palette(scope, "std_msgs/Float64", ["ros types"], 2, onto)
    assert {publisher.note, subscription.note} == {"publisher", "subscription"}
    [add] = subscription.commands
    assert add.owner == onto
    assert add.values["topic"] == add.values["name"]
    assert scope.find(add.values["type"][0]).name == "Float64"


def test_a_service_dropped_on_a_component_is_provided_or_used():
    scope = scope_of(CAR)
    onto = named(scope, bridge.Bridge, "catvehicle.bridge")
    found = palette(scope, "GlobalPoseSensor", ["services"], 9, onto)
    notes = {palette_item.note.partition(",")[0]: palette_item for palette_item in found}
    assert set(notes) == {"provides", "uses"}
    [command] = notes["provides"].commands
    assert isinstance(command, Set)
    provided = [scope.find(value).name for value in command.values]
    assert provided[-1] == "GlobalPoseSensor"
    assert len(provided) == 4


def test_nothing_is_offered_that_cannot_be_dropped():
    scope = scope_of("library/jaus/core-1.1.xmi")
    found = palette(scope, "", limit=10_000)
    assert {palette_item.group for palette_item in found} <= {"elements"}


@for_each("name", SHIPPED, shards=12, slow=True)
def test_every_model_has_a_palette_whose_references_are_known(name):
    scope = scope_of(name)
    for palette_item in palette(scope, "pose", limit=20):
        for command in palette_item.commands:
            if isinstance(command, Add):
                assert command.owner.startswith("new:") or scope.find(command.owner)
                for value in command.values.get("map", command.values.get("provides", ())):
                    assert scope.find(value) is not None


def test_what_moves_comes_before_what_every_component_has_and_new_before_old():
    found = palette(scope_of(CAR), "", ["components"], 10_000)
    assert found[0].label == "external component"
    services = found[1:]
    assert services[0].note.startswith("provides it, mobility")
    core = [service.note for service in services if ", core" in service.note]
    newest, oldest = core.index("provides it, core 1.1"), core.index("provides it, core 1.0")
    assert newest < oldest
    assert [
        palette_item.note for palette_item in palette(scope_of(CAR), "Discovery", ["components"], 2)
    ] == ["provides it, core 1.1", "provides it, core 1.0"]
    assert labels(palette(scope_of(CAR), "", ["elements"]))[:2] == ["component", "node"]


def test_an_external_component_says_that_it_exists_already():
    [item] = palette(scope_of(CAR), "external component", ["components"])
    [add] = item.commands
    assert add.values["external"] == ("true",)
    assert "exists already" in item.documentation


def test_what_fits_the_chosen_element_comes_first_and_leaves_room_for_the_rest():
    scope = scope_of(CAR)
    onto = named(scope, jaus.Component, "catvehicle.vehicle")
    found = palette(scope, "", onto=onto)
    heads = [palette_item.onto for palette_item in found]
    assert heads == sorted(heads, reverse=True)
    assert set(heads) == {"vehicle", ""}
    assert "service connection" in labels([item for item in found if item.onto], "elements")
    assert {"component", "bridge"} <= set(labels([e for e in found if not e.onto], "elements"))
    for palette_item in found:
        owner = palette_item.commands[0]
        if palette_item.onto and isinstance(owner, Add):
            assert owner.owner == onto


def test_words_look_in_both_and_what_takes_nothing_is_as_good_as_nothing():
    scope = scope_of(CAR)
    onto = named(scope, jaus.Component, "catvehicle.vehicle")
    found = palette(scope, "GlobalPoseSensor", onto=onto)
    assert [palette_item.note.partition(",")[0] for palette_item in found if palette_item.onto] == [
        "provides",
        "uses",
    ]
    assert "components" in {palette_item.group for palette_item in found if not palette_item.onto}
    whole = scope.ref(scope.model.root)
    service = scope.ref(scope.model.instances(jaus.Service)[0])
    for nothing in (whole, service, "catvehicle.xmi#//@nodes.99"):
        assert [e.id for e in palette(scope, "", onto=nothing)] == [e.id for e in palette(scope)]
