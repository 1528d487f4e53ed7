"""Measured data as they were logged: channels with units, quality and known noise, whatever the file they came from."""
