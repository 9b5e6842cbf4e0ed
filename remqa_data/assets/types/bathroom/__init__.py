"""What is found in bathrooms."""
