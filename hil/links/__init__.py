"""Links to a board: a serial port, and the simulated board in lock-step or behind a pty."""
