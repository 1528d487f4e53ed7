"""What is asked: strict YAML scenarios, their schema, and the draw that turns distributions into numbers."""
