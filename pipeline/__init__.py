"""Batch processing: commands, stages, work units, executors, run folders."""
