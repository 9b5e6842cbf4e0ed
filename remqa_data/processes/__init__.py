"""Work in other processes: executors, the workers of this machine, and how a command is stopped."""
