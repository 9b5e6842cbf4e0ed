"""What AI2-THOR calls object state changes: open, full, cooked, broken, sliced, and what one sees of that."""
