"""What the agent remembers of a room: the voxel map and the top-down semantic map."""
