"""A base class for context managers that close themselves."""

from types import TracebackType

from typing_extensions import Self


class Closing:
    """A context manager that calls `close` at its end; `close` may be called more than once."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        raise NotImplementedError
