"""Target `jaus_component`: JAUS components with skeletons."""
