"""The transport through a node manager of the host (Junior's local protocol)."""
