"""The walks that take the frames."""
