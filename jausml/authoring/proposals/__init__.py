"""Proposals of additions to a model, as commands: for the studio and the verbs of `new`."""
