"""Hardware in the loop: the controller runs on a board, real or simulated, at the other end of a serial line."""
