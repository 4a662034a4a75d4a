"""Reference pages made from the program itself, in `reference/generated/`.

The case file's page comes from its JSON Schema, the command's from its argument parser, the page
of surfaces and laws from the registries, the Python pages from the modules there are.
"""

import argparse
import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

from case_reference import TRACE_INTRODUCTION, CaseReference
from markdown_parts import code, table

# --- command -----------------------------------------------------------------------------------


def subparsers(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return the subcommands of a parser."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            return dict(action.choices)
    return {}


def arguments(parser: argparse.ArgumentParser) -> Iterator[tuple[str, str]]:
    """Yield each argument of a parser and what it does."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction | argparse._HelpAction):
            continue
        name = ", ".join(action.option_strings) or str(action.metavar or action.dest)
        if action.option_strings and action.nargs != 0:
            name += f" {action.metavar or action.dest.upper()}"
        text = action.help or ""
        yield f"`{name}`", text % {**vars(action), "prog": parser.prog}


def command_page(parser: argparse.ArgumentParser) -> str:
    """Return the reference page of the command."""
    parts = [f"# Command\n\n{parser.description or ''}\n"]
    top = table(("argument", "meaning"), arguments(parser))
    for name, sub in [("", parser), *subparsers(parser).items()]:
        usage = " ".join(sub.format_usage().removeprefix("usage: ").split())
        if name:
            about = (sub.description or "").strip()
            body = table(("argument", "meaning"), arguments(sub))
            parts.append(f"## {name}\n\n{about}\n\n```console\n$ {usage}\n```\n\n{body}")
        else:
            parts.append(f"```console\n$ {usage}\n```\n\n{top}")
    return "\n".join(parts)


# --- surfaces, laws, rules ---------------------------------------------------------------------


def registry_page(registries: Mapping[str, Iterable[Any]]) -> str:
    """Return the page of everything that is registered."""
    parts = [
        "# Surfaces, directions, laws and rules\n",
        "`anisocontact info` prints the same. In a case file the key of an angle ends in "
        "`_deg`; Python takes it in degrees by that name, or in radian without `_deg`.\n",
    ]
    for title, entries in registries.items():
        parts.append(f"## {title}\n")
        for entry in entries:
            rows = (
                (f"`{p.name}`", parameter_form(p), p.unit, parameter_default(p), p.doc)
                for p in entry.parameters
            )
            body = table(("parameter", "value", "unit", "default", "meaning"), rows)
            parts.append(f"### `{entry.name}`\n\n{entry.doc}\n\n{body or 'No parameters.'}\n")
    return "\n".join(parts)


def quantities_page(rows: Iterable[Any], files: Mapping[str, str]) -> str:
    """Return the page of all that a run writes of bodies and contacts."""
    parts = [
        "# Output quantities\n",
        "What a [results folder](../results-folder.md) has, one table for each sort of file. "
        "`quantities` of `[output]` chooses among the arrays for ParaView; `*` marks the ones that "
        "are always there, for pictures are made of them. [](../../dev/how-to-add.md) adds one.\n",
    ]
    known = list(rows)
    for at, file in files.items():
        body = table(
            ("quantity", "unit", "meaning"),
            ((f"`{q.name}`{' *' * q.always}", q.unit, q.doc) for q in known if q.at == at),
        )
        parts.append(f"## Of a {at}: {file}\n\n{body}\n")
    return "\n".join(parts)


def parameter_form(parameter: Any) -> str:
    """Return the form and bound of a parameter."""
    if parameter.choices:
        return ", ".join(code(choice) for choice in parameter.choices)
    return parameter.kind if parameter.bound == "any" else f"{parameter.kind}, {parameter.bound}"


def parameter_default(parameter: Any) -> str:
    """Return what holds where the parameter is left out."""
    if parameter.required:
        return "required"
    if parameter.choices:
        return code(parameter.choices[int(parameter.default[0])])
    return ", ".join(f"{value:g}" for value in parameter.default)


# --- Python ------------------------------------------------------------------------------------


#: What users need of the lowest package; the rest of it is for the other packages alone.
OF_BASE = {"base.errors", "base.registry"}


def public_modules(folder: Path) -> list[str]:
    """Return the names of the modules a user imports from: what is inside a package, it exports."""
    names = {m.name for m in pkgutil.iter_modules([str(folder)]) if not m.name.startswith("_")}
    return [f"anisocontact.{name}" for name in sorted(names - {"base"} | OF_BASE)]


def module_page(name: str) -> str:
    """Return the reference page of a module."""
    return f"# `{name}`\n\n```{{eval-rst}}\n.. automodule:: {name}\n```\n"


# --- Sphinx ------------------------------------------------------------------------------------


def escape_bars(
    _app: Sphinx, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]
) -> None:
    """Keep |N| in docstrings what it is; reStructuredText would look for a substitution."""
    lines[:] = [
        line if "``" in line or line.lstrip().startswith(">>>") else line.replace("|", r"\|")
        for line in lines
    ]


def write_pages(app: Sphinx) -> None:
    """Write the pages that changed and remove those whose origin is gone."""
    from anisocontact.base import registry
    from anisocontact.base.amplitudes import amplitudes
    from anisocontact.base.paths import paths
    from anisocontact.case import json_schema
    from anisocontact.case.trace import trace_schema
    from anisocontact.cli import build_parser
    from anisocontact.results.quantities import FILES, quantities

    registries = {
        "Surfaces": registry.surfaces(),
        "Direction fields": registry.direction_fields(),
        "Normal laws": registry.normal_laws(),
        "Adhesion models": registry.adhesion_models(),
        "Friction models": registry.friction_models(),
        "Sliding rules": registry.sliding_rules(),
        "Amplitudes": amplitudes(),
        "Paths": paths(),
    }
    pages = {
        "case-file": CaseReference(json_schema()).page(),
        "trace-file": CaseReference(trace_schema(), TRACE_INTRODUCTION, "trace-").page(),
        "command": command_page(build_parser()),
        "laws": registry_page(registries),
        "quantities": quantities_page(quantities(), FILES),
    }
    source = Path(app.srcdir).parent / "src" / "anisocontact"
    for name in public_modules(source):
        pages[f"python/{name}"] = module_page(name)

    folder = Path(app.srcdir) / "reference" / "generated"
    for old in folder.rglob("*.md"):
        if old.relative_to(folder).with_suffix("").as_posix() not in pages:
            old.unlink()
    for name, text in pages.items():
        path = folder / f"{name}.md"
        if not path.is_file() or path.read_text() != text:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)


def mend_source_links(app: Sphinx) -> list[Any]:
    """Let the pages of source code lead back to where a name is documented.

    `sphinx.ext.viewcode` keeps one module to lead back to for each source file, and for each name
    the last page that has it; what two pages have (its own, and that of a module that exports it,
    too) would get the page of one and the name of the other. It lists sources that it could not
    read as well.
    """
    modules = getattr(app.env, "_viewcode_modules", {})
    known = app.env.domains.python_domain.objects.items()
    documented = {name: entry.docname for name, entry in known if not entry.aliased}
    for name, entry in list(modules.items()):
        if not entry:
            del modules[name]
            continue
        code, tags, used, first = entry
        # its own page has all that a module exports, another one may have less
        module = name if all(f"{name}.{one}" in documented for one in used) else first
        used |= {one: documented.get(f"{module}.{one}", page) for one, page in used.items()}
        modules[name] = code, tags, used, module
    return []


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages before Sphinx looks for sources."""
    app.connect("builder-inited", write_pages)
    app.connect("html-collect-pages", mend_source_links, priority=400)  # before viewcode's
    app.connect("autodoc-process-docstring", escape_bars)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
