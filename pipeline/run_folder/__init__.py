"""The output folder: what it holds, what is done, what has changed."""
