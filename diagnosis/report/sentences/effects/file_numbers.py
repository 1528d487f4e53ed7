"""What the file of an effect says about its numbers, beside those that were fitted."""

from collections.abc import Sequence

from diagnosis.inference.naming.file_numbers import MAX_APART, FileNumber, agree
from diagnosis.inference.naming.named_effect import NamedEffect
from diagnosis.inference.selection.rivals import AS_GOOD
from diagnosis.report.sentences.quantities import cost, with_error

OTHER_NUMBERS = "the same form as in its file, with other numbers"


def file_number(number: FileNumber, between: str = "±") -> str:
    """Return a number of the file, and how far the fitted one is away."""
    return f"{with_error(number.value, number.std, between)}, {number.apart:.1f} standard errors away"


def label(named: NamedEffect) -> str:
    """Return the name of an effect, with a remark if its file states other numbers."""
    return named.effect.name if agree(named.file_numbers) else f"{named.effect.name} ({OTHER_NUMBERS})"


def comparison(named: NamedEffect, rise_if_held: float, rise_without: float) -> str:
    """Return whether the data confirm the numbers of the file, and what these explain, in sentences.

    Args:
        named: An effect whose file states numbers.
        rise_if_held: Rise of the cost with the numbers held at those of the file.
        rise_without: Rise of the cost without the effect.
    """
    held = f"with the numbers of the file held, the cost rises by {cost(max(0.0, rise_if_held))}"
    if agree(named.file_numbers):
        return f"The fitted numbers agree with those of the file within {MAX_APART:g} standard errors; {held}"
    refused = "The same form with other numbers: these data do not confirm the law of the file"
    return f"{refused}. {held[0].upper()}{held[1:]}; without the effect, by {cost(rise_without)}"


def unnamed_comparison(change: float, numbers: Sequence[FileNumber]) -> str:
    """Return what data in which an effect is not named say about the numbers of its file, as a clause.

    Args:
        change: Rise of the cost with the effect as its file has it, compared with the model without the effect.
        numbers: The numbers of the file beside those of the fit.
    """
    text = f"with the numbers of its file, the cost {'rises' if change > 0.0 else 'falls'} by {cost(abs(change))}"
    if change > AS_GOOD:
        return f"{text}: these data contradict them"
    if not agree(numbers):
        return f"{text}, and the fitted ones are more than {MAX_APART:g} standard errors away"
    return f"{text}: these data agree with them" if change < -AS_GOOD else f"{text}, which decides nothing"
