"""Workers: generated code of a model in a process of its own, to put values through it."""
