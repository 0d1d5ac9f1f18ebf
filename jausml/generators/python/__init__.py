"""What all targets that write Python share: names, layout, imports, package files."""
