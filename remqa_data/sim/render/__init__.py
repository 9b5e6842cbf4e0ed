"""Cameras and the rasteriser: colour, depth and instance images."""
