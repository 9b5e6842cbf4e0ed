"""Where rooms come from."""
