"""What is submitted: tracks, columns, and reading it in bounded memory."""
