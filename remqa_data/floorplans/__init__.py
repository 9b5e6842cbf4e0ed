"""Where rooms come from: recorded floor plans and sampled ones."""
