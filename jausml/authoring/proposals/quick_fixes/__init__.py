"""Quick fixes by rule: commands where one change is what anybody would do about a finding."""
