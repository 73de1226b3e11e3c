"""A report as a PDF: printed by Chromium without a window, or else set by WeasyPrint."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import tempfile
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from armodal.protocols.errors import SessionError

__all__ = ["check_prints", "print_pdf"]

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PATIENCE_S = 120.0  # a page of the demo takes two seconds; a busy machine many times that
SETTER = "weasyprint"


def check_prints() -> None:
    """Refuse to print, before the work, where nothing can.

    Raises
    ------
    SessionError
        If neither Chromium nor WeasyPrint with its libraries is there.
    """
    if _browser() is not None:
        return
    if find_spec(SETTER) is None:
        raise SessionError(
            "--pdf: wanted Chromium, Chrome or the Python package weasyprint (the extra pdf) to "
            "print with, found none; install one, or open the HTML report and print it from the "
            "browser"
        )
    _setter()


def print_pdf(page: Path, pdf: Path) -> None:
    """Print a page; an older file is replaced only when the new one is complete.

    Raises
    ------
    SessionError
        If nothing can print, or printing fails.
    """
    check_prints()
    browser = _browser()
    with tempfile.TemporaryDirectory(prefix=".pdf-", dir=pdf.parent) as folder:
        made = Path(folder) / "page.pdf"
        if browser is None:
            _setter().HTML(filename=str(page)).write_pdf(str(made))
        else:
            _by_browser(browser, page, made, Path(folder) / "profile")
        if not made.is_file():
            raise SessionError(
                f"{page} could not be printed; it is left as it is: open it in a browser and print "
                "it from there"
            )
        made.replace(pdf)


def _setter() -> ModuleType:
    """WeasyPrint, silent about the CSS that it passes over; it loads libraries of the system."""
    logging.getLogger(SETTER).setLevel(logging.ERROR)
    try:
        return import_module(SETTER)
    except OSError as error:
        raise SessionError(
            f"--pdf: weasyprint does not find the library Pango ({error.args[0].splitlines()[0]}); "
            "install Pango or Chromium, or open the HTML report and print it from the browser"
        ) from error


def _browser() -> str | None:
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def _by_browser(browser: str, page: Path, made: Path, profile: Path) -> None:
    command = [
        browser,
        "--headless",
        "--disable-gpu",
        f"--user-data-dir={profile}",
        "--no-pdf-header-footer",
        f"--print-to-pdf={made}",
        page.resolve().as_uri(),
    ]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        command.insert(1, "--no-sandbox")  # it refuses to run as root otherwise
    try:
        subprocess.run(command, check=False, capture_output=True, timeout=PATIENCE_S)  # noqa: S603
    except subprocess.TimeoutExpired as late:
        raise SessionError(
            f"{Path(browser).name} took longer than {PATIENCE_S:.0f} s to print {page}; open it in "
            "a browser and print it from there"
        ) from late
