"""Cures by rule: commands that make a finding go away where one change is what anybody would do."""
