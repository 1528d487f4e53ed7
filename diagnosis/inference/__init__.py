"""From residuals to named causes: hypotheses, fits, their selection, and what stays open."""
