"""The arm: kinematics, postures, obstacles, and the search for a free movement."""
