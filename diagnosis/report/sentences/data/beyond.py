"""The warning that unseen runs leave the range in which effects were seen: one sentence with a list."""

from collections.abc import Iterable, Iterator

from diagnosis.prediction_error import UnseenPrediction

BEYOND_SENTENCE = "Effects are used outside the range in which they were seen, and the intervals are wider there:"


def beyond_list(unseen: Iterable[UnseenPrediction]) -> Iterator[str]:
    """Yield a line for each file, effect and condition; none if no run leaves a range."""
    for prediction in unseen:
        yield from (f"{prediction.file}: {left.text}" for left in prediction.beyond)
