"""Configurations of `remqa-gen` that come with the package: `remqa-gen --config tiny`."""
