"""Small and portable things of all rooms."""
