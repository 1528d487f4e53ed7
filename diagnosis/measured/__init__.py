"""Measured data as they were logged: channels with units, quality and known noise, from any kind of file."""
