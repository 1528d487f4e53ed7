"""Stages that predict current and speed of a motor on a bench."""
