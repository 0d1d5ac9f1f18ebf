"""JAUS components with skeletons."""
