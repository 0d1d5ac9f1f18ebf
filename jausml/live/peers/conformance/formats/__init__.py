"""Output formats of conformance reports, one module each; every module has a function `render`."""
