"""What the module raises."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ._solution import Solution


class SceneError(ValueError):
    """A problem that cannot be used: the message of the command line, with place and mend.

    Attributes:
        message: what is wrong, and what to do.
        file: name of the text, as it was given.
        line: line in it, from 1; 0 for the whole text.
        column: column in characters, from 1.
        text: that line.
    """

    def __init__(
        self, whole: str, message: str = "", file: str = "", line: int = 0, column: int = 0, text: str = ""
    ) -> None:
        super().__init__(whole, message, file, line, column, text)
        self.message = message or whole
        self.file = file
        self.line = line
        self.column = column
        self.text = text
        if text:
            self.add_note(f"    {text}\n    {' ' * (column - 1)}^")

    def __str__(self) -> str:
        return str(self.args[0])


class NotConverged(RuntimeError):
    """A solve that failed, and was asked to raise. `solution` says why: status and message."""

    def __init__(self, solution: Solution) -> None:
        super().__init__(solution)
        self.solution = solution

    def __str__(self) -> str:
        return f"{self.solution.status}: {self.solution.message}"
