"""The batch: command line, plan, stages, dataset."""
