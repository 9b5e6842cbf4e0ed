"""The truths of a dataset, checked from its files."""
