"""The output folder: its content, what is done, what has changed."""
