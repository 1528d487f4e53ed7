"""Links to a board: a serial port, the simulated board in lock-step or behind a pty, and a stand-in."""
