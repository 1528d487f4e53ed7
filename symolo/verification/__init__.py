"""What can be wrong with a released dataset, found from its folder alone."""
