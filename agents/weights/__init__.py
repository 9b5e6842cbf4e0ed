"""Weights that come with the package, as `remqa-agent train` made them of data version 1.0."""
