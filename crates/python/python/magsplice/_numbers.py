"""Results that print as names and numbers."""

from __future__ import annotations

from typing import Any

from magsplice import _html


class Numbers:
    """A result that prints as lines of names and numbers."""

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name, without arrays of points; for JSON."""
        raise NotImplementedError

    def __str__(self) -> str:
        return "\n".join(f"{name:<28} {_html.digits(value)}" for name, value in self._shown())

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}>\n{self}"

    def _shown(self) -> list[tuple[str, Any]]:
        return list(self.to_dict().items())

    def _repr_html_(self) -> str:
        return _html.number_table(self._shown())
