"""Pages keep within the window of a telephone: checked in Chromium, where there is one."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util import logging

WIDTHS = (390, 1280)  # CSS pixels: a telephone, a laptop
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
LONGEST_S = 300.0
_REPORT = "widths-report.html"
# Each page in a frame of each width; what is wider than it, and pictures that are not there.
_SCRIPT = """<!doctype html><body><script>
const pages = %s, widths = %s, found = [];
async function look(page, width) {
  const frame = document.createElement("iframe");
  frame.style = `border:0;height:800px;width:${width}px`;
  frame.src = page;
  await new Promise(done => { frame.onload = done; document.body.append(frame); });
  const inside = frame.contentDocument, root = inside.scrollingElement;
  for (const image of inside.images) image.loading = "eager";
  await Promise.all([...inside.images].map(image => image.complete || new Promise(done => {
    image.onload = image.onerror = done;
  })));
  if (root.scrollWidth > width) found.push([page, width, `is ${root.scrollWidth} px wide`]);
  for (const image of inside.images)
    if (!image.naturalWidth) found.push([page, width, `lacks ${image.getAttribute("src")}`]);
  frame.remove();
}
(async () => {
  for (const page of pages) for (const width of widths) await look(page, width);
  await fetch("found", {method: "POST", body: JSON.stringify(found)});
})();
</script>"""


class _Server(ThreadingHTTPServer):
    """Serves the site, and waits for what the browser found."""

    def __init__(self, site: Path) -> None:
        super().__init__(("127.0.0.1", 0), partial(_Handler, directory=str(site)))
        self.found: list[list[str | int]] = []
        self.told = threading.Event()


class _Handler(SimpleHTTPRequestHandler):
    server: _Server

    def do_POST(self) -> None:
        """Take what was found."""
        self.server.found = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.send_response(204)
        self.end_headers()
        self.server.told.set()

    def log_message(self, *_: object) -> None:
        """Say nothing."""


def too_wide(site: Path, browser: str) -> list[tuple[str, int, str]]:
    """Return page, width and fault of what does not fit, or is not there.

    Raises
    ------
    RuntimeError
        If the browser did not come to an end.
    """
    pages = sorted(path.relative_to(site).as_posix() for path in site.rglob("*.html"))
    (site / _REPORT).write_text(_SCRIPT % (json.dumps(pages), json.dumps(WIDTHS)))
    server = _Server(site)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            looking = subprocess.Popen(  # noqa: S603 - the browser of this machine
                [
                    browser,
                    "--headless",
                    "--no-sandbox",
                    "--disable-gpu",
                    f"--user-data-dir={profile}",
                    f"http://127.0.0.1:{server.server_port}/{_REPORT}",
                ],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            try:
                if not server.told.wait(LONGEST_S):
                    raise RuntimeError(f"{browser} did not look at every page")
            finally:
                looking.terminate()
                looking.wait()
    finally:
        server.shutdown()
        server.server_close()
        (site / _REPORT).unlink()
    return [(str(page), int(width), str(fault)) for page, width, fault in server.found]


def _finished(app: Sphinx, error: Exception | None) -> None:
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if error is not None or browser is None or app.builder.name != "html":
        return
    for page, width, fault in too_wide(Path(app.outdir), browser):
        logging.getLogger(__name__).warning("%s at %s px %s", page, width, fault)


def setup(app: Sphinx) -> dict[str, bool]:
    """Look at the pages when they are all written."""
    app.connect("build-finished", _finished)
    return {"parallel_read_safe": True}
