"""New rooms after the statistics of the recorded ones."""
