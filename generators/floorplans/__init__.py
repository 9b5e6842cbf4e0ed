"""Kept for code that imports floor plans from here; they live in `remqa_data.floorplans`."""
