"""The diagnosis as a command: it reads cases, diagnoses them and writes the files."""
