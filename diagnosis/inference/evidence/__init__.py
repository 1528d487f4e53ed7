"""The residuals that hypotheses are compared on, and what is known of their noise."""
