"""What several targets share: naming, views of messages, package files."""
