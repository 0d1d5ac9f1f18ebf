"""What may be added to a model, as commands: asked by the studio and by the verbs that make."""
