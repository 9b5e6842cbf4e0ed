"""Meshes: primitives, grids, cloth, swept and extruded solids."""
