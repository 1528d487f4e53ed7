"""Why a file cannot be used; the error is reported at the field that names it."""


class Refusal(Exception):  # noqa: N818 - becomes an InputError where the field is known
    """The reason why a file cannot be used, as words that follow the name of its field.

    Args:
        text: What is wrong.
        cure: What to do about it.
        is_missing: Whether there is no such file, so that a similar name is suggested.
    """

    def __init__(self, text: str, *, cure: str = "", is_missing: bool = False) -> None:
        super().__init__(text)
        self.cure = cure
        self.is_missing = is_missing
