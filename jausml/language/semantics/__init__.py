"""Facts about models, asked by rules, generators and editors: paths, units, ranges, services."""
