"""AI2-THOR's actions, by what they act on."""
