"""Design of the next trial: the measurement that distinguishes the effects between which a diagnosis cannot decide."""
