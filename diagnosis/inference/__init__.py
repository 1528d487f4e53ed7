"""From residuals to named causes: hypotheses, fits, their selection, and what must be said beside the names."""
