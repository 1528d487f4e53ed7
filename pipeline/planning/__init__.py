"""What a scenario would make and what it would cost."""
