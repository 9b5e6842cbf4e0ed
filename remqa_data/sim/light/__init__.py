"""Indirect light of a room: computed once from what never moves, looked up by whatever is drawn."""
