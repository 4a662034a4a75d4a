"""What a user can get wrong, said in one line."""

from __future__ import annotations

__all__ = ["InputError"]


class InputError(ValueError):
    """A mistake in the input: one line names the field, what was given and what is allowed.

    Args:
        message: the line, without a final newline; line breaks in it become spaces, other
            characters that do not print are written as escapes.
        field: dotted path of the field or entity, `contact[0].friction.coefficients`; `""` if
            the mistake has no place of its own. Put in front of the message unless it is there.

    Attributes:
        field: the dotted path as given.

    Example:
        >>> str(InputError("given -0.3, must be positive", field="friction.coefficients"))
        'friction.coefficients: given -0.3, must be positive'
    """

    def __init__(self, message: str, field: str = "") -> None:
        line = " ".join(message.split())
        if field and not line.startswith(f"{field}:"):
            line = f"{field}: {line}"
        super().__init__("".join(c if c.isprintable() else repr(c)[1:-1] for c in line))
        self.field = field
