"""Matchers that come with the package and are heard together: `remqa-agent predict three_matchers`."""
