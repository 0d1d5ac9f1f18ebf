"""Facts about models that rules ask for: layouts, paths, topics, provided services, names."""
