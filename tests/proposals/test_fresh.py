"""Names that are free."""

from jausml.authoring.proposals.new_elements import free_name


def test_a_name_of_any_length_can_be_made_unique():
    taken = ["x" * 2000]
    for _ in range(3):
        name = free_name("x" * 2000, taken)
        assert name not in taken
        taken.append(name)
    assert taken[2] != taken[3]
