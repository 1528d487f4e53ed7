"""Effects on current and speed as the instruments of a motor bench measure them."""
