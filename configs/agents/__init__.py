"""Systems of `remqa-agent` that come with the package: `remqa-agent run semantic_map`."""
