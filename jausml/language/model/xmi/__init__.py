"""XMI 2.0: documents to nodes, fragments, and elements back to documents."""
