"""Output formats of reports, one module each; every module has a function `render`."""
