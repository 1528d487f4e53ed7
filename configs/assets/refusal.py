"""Why a file cannot be used, to be told at the field that names it."""


class Refusal(Exception):  # noqa: N818 - becomes an InputError where the field is known
    """In words that follow the file's name.

    Args:
        text: What is wrong.
        cure: What to do about it.
        is_missing: Whether there is no such file, so that another name may be meant.
    """

    def __init__(self, text: str, *, cure: str = "", is_missing: bool = False) -> None:
        super().__init__(text)
        self.cure = cure
        self.is_missing = is_missing
