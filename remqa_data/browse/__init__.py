"""`remqa-data browse`: a dataset as pages for people, served on this machine or written as files."""
