"""The classes of the metamodels, one module for each language, for annotations and `isinstance`.

`jaus.Component` is the class that pyecore made of `jaus.ecore`, so a component of a model is an
instance of it. The features stand in the stubs beside the modules, which
`tools/build_model_types.py` writes from the metamodels (ADR 10).
"""
