"""Parts that several object types are made of: carcasses, fronts, basins, table tops."""
