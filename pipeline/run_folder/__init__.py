"""The output folder: its content, the stages that are done, and the inputs that have changed."""
