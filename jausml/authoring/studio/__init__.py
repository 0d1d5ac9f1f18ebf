"""The visual environment: a local server for a page that shows, edits and watches systems."""
