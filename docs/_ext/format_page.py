"""The page of file formats, from what each says of itself."""

from __future__ import annotations

from armodal.protocols.foreign.file_format import every_format


def format_page() -> dict[str, str]:
    """Return the page by its file name."""
    rows = "\n".join(
        f"| {own.name} | {' '.join(f'`{ending}`' for ending in own.endings) or '-'} | {own.holds} |"
        for own in every_format()
    )
    return {
        "formats.md": (
            "# File formats\n\n`armodal inspect` and `armodal import` read these. The first bytes "
            "of a file tell its format; the ending tells it where they are damaged. "
            "[Import and export](../../exchange.md) says what becomes of the arrays.\n\n"
            f"| format | endings | holds |\n|---|---|---|\n{rows}\n"
        )
    }
