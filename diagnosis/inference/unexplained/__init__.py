"""Whether the residuals of the best model still have structure, and where."""
