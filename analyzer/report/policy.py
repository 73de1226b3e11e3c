"""What a page may run: the scripts it was written with, and nothing else."""

from __future__ import annotations

import hashlib
import re
from base64 import b64encode
from collections.abc import Sequence

__all__ = ["under_policy"]

# Data blocks, which are no script, name a type of their own. From one `<` to the next: a library's
# megabytes are passed over in a fifth of the time that `.*?` takes.
_SCRIPT = re.compile(
    r"<script(?! type=\"(?:application/json|text/plain)\")[^>]*>"
    r"([^<]*+(?:<(?!/script>)[^<]*+)*+)</script>",
    re.IGNORECASE,
)
_HEAD = '<meta charset="utf-8">'


def under_policy(html: str, *, later: Sequence[str] = (), trusting: bool = False) -> str:
    """Return the page with a Content-Security-Policy that allows its own inline scripts by hash.

    Handlers of events and addresses of scripts do not run, and nothing is fetched or sent (W3C,
    Content Security Policy Level 3, sections 6.1 and 6.7.3). That text from files brings no script
    element of its own is up to whoever writes the page: it is escaped there.

    Parameters
    ----------
    later
        Scripts that those of the page put into it, allowed by their hash too.
    trusting
        Whether those of the page may bring a script from a file (`'strict-dynamic'`).

    Raises
    ------
    ValueError
        If the page has no ``<meta charset="utf-8">``, behind which the policy goes.
    """
    before, head, after = html.partition(_HEAD)
    if not head:
        raise ValueError(f"wanted a page with {_HEAD}, found none; give it one in its head")
    digests = dict.fromkeys(
        b64encode(hashlib.sha256(script.encode()).digest()).decode()
        for script in (*_SCRIPT.findall(html), *later)
        if script
    )
    scripts = " ".join(f"'sha256-{digest}'" for digest in digests) or "'none'"
    if trusting:
        scripts += " 'strict-dynamic'"
    policy = (
        f"default-src 'none'; script-src {scripts}; style-src 'unsafe-inline'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    meta = f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
    return f"{before}{head}{meta}{after}"
