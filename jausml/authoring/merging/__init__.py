"""Three-way merges of models: what one side did is done to the other, by elements and not lines."""
