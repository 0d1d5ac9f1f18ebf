"""What a component keeps to itself."""


def test_private_attributes_of_a_subclass_do_not_meet_those_of_the_base(world):
    """A user's `self._events` once replaced the Events service of the component."""
    component = world.component("1.1.1")
    private = [name for name in vars(component) if name.startswith("_")]
    assert private
    assert [name for name in private if not name.startswith("_jaus_")] == []
