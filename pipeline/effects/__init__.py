"""Effects of a user's own: their contract, their files, and the texts about all effects."""
