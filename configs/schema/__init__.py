"""The documented schema: one module per section of a scenario, numbers only.

A scenario file may hold a distribution at any leaf; the models here describe what is left once it is drawn.
"""
