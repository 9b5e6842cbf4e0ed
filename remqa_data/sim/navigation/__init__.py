"""Where the agent can stand and how it gets there: grid, paths, viewpoints."""
