"""Judgement of an estimated trajectory by the true poses of a run: `symolo.evaluate`; docs/baselines.md."""
