"""The only folder that loads PyTorch, from the extra `learn`."""
