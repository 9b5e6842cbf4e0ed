"""Where compiled kernels are kept, and who wants to know that they are being compiled."""
