"""Markdown of the generated pages."""

from collections.abc import Iterable


def table(header: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table; empty without rows."""
    cells = ([cell.replace("|", r"\|").replace("\n", " ") for cell in row] for row in rows)
    lines = [[*header], *cells]
    if len(lines) == 1:
        return ""
    lines.insert(1, ["---"] * len(lines[0]))
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def toml(value: object) -> str:
    """Return a value as TOML writes it; of numbers what they were given as, not their rounding."""
    if isinstance(value, float):
        return str(float(f"{value:.12g}"))
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, dict) and value:
        return f"{{ {', '.join(f'{key} = {toml(item)}' for key, item in value.items())} }}"
    return str(value)


def code(value: object) -> str:
    """Return a value as TOML writes it, in code style."""
    return f"`{toml(value)}`"
