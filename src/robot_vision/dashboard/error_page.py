"""The page that says in words what is wrong with a request."""

import base64
import hashlib
from html import escape
from typing import Tuple

_STYLE = (
    ":root{color-scheme:light dark;font-family:system-ui,sans-serif;line-height:1.5}"
    "body{max-width:36rem;margin:15vh auto;padding:0 1.5rem}h1{font-size:1.4rem}"
)
_HASH = base64.b64encode(hashlib.sha256(_STYLE.encode()).digest()).decode()
# The page needs no role, and so uses no file.
ERROR_PAGE_POLICY = (
    f"default-src 'none'; style-src 'sha256-{_HASH}'; frame-ancestors 'none'; base-uri 'none'; "
    "form-action 'none'"
)
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>robot_vision</title><style>{style}</style></head>
<body><h1>{title}</h1><p>{text}</p><p><a href="/">Try again</a></p></body></html>
"""

OPEN_PRINTED = (
    "Open the address that the dashboard has printed where it was started: "
    "a line as dashboard: http://.../?token=... in that terminal. "
    "Each start makes a new token, unless the parameter ~token names one."
)


def error_page(title: str, text: str) -> str:
    """Returns an HTML page that says what is wrong."""
    return _PAGE.format(style=_STYLE, title=escape(title), text=escape(text))


def words_of(status: int) -> Tuple[str, str]:
    """Returns title and text for an HTTP status that has no better ones."""
    return {
        404: ("Not here", "The dashboard has no page of this name."),
        405: ("Not so", "The dashboard does not take this kind of request here."),
        400: ("Not understood", "The request is malformed."),
        503: ("Too many pages", "The dashboard serves no more of them: close another one."),
    }.get(status, ("Not possible", "The dashboard could not do this; its log may say why."))
