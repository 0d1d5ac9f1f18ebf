"""The target `messages`: one package with the classes of all JAUS messages of a system."""
