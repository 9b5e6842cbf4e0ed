"""What is found in kitchens."""
