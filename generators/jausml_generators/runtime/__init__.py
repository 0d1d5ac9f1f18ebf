"""Target `runtime`: copies the runtime into the workspace as the package `jausml_runtime`."""
