"""The simulated board: a C program on libsimavr, built at first use and run as a child process."""
