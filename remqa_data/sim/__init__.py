"""The simulated world: physics, camera and frames."""
