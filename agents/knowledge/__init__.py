"""What an agent knows before and while it acts: the question it reads, and what the walk through the room has shown."""
