"""The 120 iTHOR floor plans as scenes."""
