"""Commands for measured data: cases, diagnoses, the next trial, and validation of parts of the robot."""
