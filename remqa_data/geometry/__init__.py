"""Boxes and rotations, and the array types that all of the library uses."""
