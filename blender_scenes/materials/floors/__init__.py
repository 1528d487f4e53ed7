"""Materials of floors."""
