"""A finished dataset counted and measured again, from its files and pictures alone: nothing is simulated here."""
