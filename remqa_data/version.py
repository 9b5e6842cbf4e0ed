"""The version of this package, and its day."""

__version__ = "1.0.0"
RELEASED = "2026-11-22"
"""Of this version, for the files of a dataset: they are the same on every day on which they are made."""
