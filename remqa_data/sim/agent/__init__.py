"""The embodied agent: its body, its actions, and their replay."""
