"""Which effects the data need: candidates, stepwise selection, rivals and refusals."""
