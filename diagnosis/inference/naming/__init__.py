"""From the selected effects to the verdict: which names stand, and in which range they hold."""
