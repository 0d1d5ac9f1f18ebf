"""Rules about bridges, connections and attribute maps."""
