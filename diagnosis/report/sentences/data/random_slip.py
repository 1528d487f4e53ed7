"""The sentence about the random slip of the wheels."""

from collections.abc import Iterator

from diagnosis.posterior.random_slip import RandomSlipEstimate
from diagnosis.report.sentences.quantities import with_error


def random_slip_sentences(slip: RandomSlipEstimate | None) -> Iterator[str]:
    """Yield a sentence if a log of drives shows the slip."""
    if slip is not None:
        mm = 1e3 * slip.slip_m_sqrt_m
        yield (
            f"The travel of each wheel has a random error of {with_error(mm, mm * slip.sd_log)} mm after 1 m, which "
            "grows with the root of the distance (random_slip). It is part of the noise here. extended.yaml has it, "
            "and `--like` draws it."
        )
