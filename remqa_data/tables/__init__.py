"""The four tables: typed rows, Arrow schemas, images."""
