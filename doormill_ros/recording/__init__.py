"""Bags: write them while a run happens, read them back, replay them."""
