"""Folders of models as a team keeps them: made once, then theirs."""
