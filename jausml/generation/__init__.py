"""Model to text: render to memory, plan, then act; nothing here prints."""
