"""Things that are let go of."""

from types import TracebackType
from typing import Self


class Closing:
    """A context that ends with `close`, which may be called again."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        raise NotImplementedError
