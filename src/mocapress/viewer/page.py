"""The page as one document: markup, style, scripts and motion, with nothing to be fetched.

The scripts are modules that import each other by relative paths. An import map gives each of them
under its path as a ``data:`` URL, so that they are the same files in a checkout, in its tests and
in the document, without a bundler.
"""

import base64
import hashlib
import json
import posixpath
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

# A wheel carries the sources beside this module; a checkout has them in its folder viewer/.
_PACKAGED = Path(__file__).with_name("web")
SOURCES = _PACKAGED if _PACKAGED.is_dir() else Path(__file__).parents[3] / "viewer"

_MAIN = "page/main.js"
_VENDORED = {
    "three": "vendor/three/three.module.min.js",
    "three/addons/controls/OrbitControls.js": "vendor/three/OrbitControls.js",
}
_IMPORT = re.compile(r"""(\b(?:from|import)\s*)(["'])([^"'\n]+)\2""")


def document(clips: Sequence[dict[str, Any]], title: str = "mocapress") -> str:
    """Give the page that plays these clips.

    Parameters
    ----------
    clips
        As ``embed`` makes them.
    title
        Of the browser's window.

    Returns
    -------
    str
        HTML; its policy (``policy``) allows no request to anywhere.

    """
    style, imports, start = _parts()
    # In a script element only "<" can end the text early or begin a comment.
    motion = json.dumps({"clips": clips}, separators=(",", ":")).replace("<", "\\u003c")
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy()}">\n'
        f"<title>{_escaped(title)}</title>\n<style>{style}</style>"
    )
    body = (
        f'<script type="importmap">{imports}</script>\n'
        f'<script type="application/json" id="clips">{motion}</script>\n'
        f'<script type="module">{start}</script>\n'
        f"<!--\n{_text('vendor/three/LICENSE')}-->"
    )
    markup = _text("page/index.html")
    return markup.replace("<!-- head -->", head).replace("<!-- body -->", body)


def policy() -> str:
    """Give the content security policy: only the page's own scripts and style, no connections."""
    style, imports, start = (_digest(part) for part in _parts())
    return (
        f"default-src 'none'; script-src {imports} {start} data:; style-src {style}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _parts() -> tuple[str, str, str]:
    """Give style, import map and first script."""
    urls = {name: _data_url(source) for name, source in sorted(_modules().items())}
    return _text("page/style.css"), json.dumps({"imports": urls}), f'import "{_MAIN}";'


def _modules() -> dict[str, str]:
    """Give all modules that the first one needs, by their paths, imports by these paths, too."""
    found: dict[str, str] = {}
    pending = [_MAIN]
    while pending:
        path = pending.pop()
        if path in found:
            continue

        def rename(match: re.Match[str], path: str = path) -> str:
            target = _target(path, match[3])
            if target is None:
                return match[0]
            pending.append(target)
            return f'{match[1]}"{target}"'

        source = _IMPORT.sub(rename, _text(path))
        found[path] = f"{source}\n//# sourceURL=mocapress/{path}\n"
    return found


def _target(importer: str, specifier: str) -> str | None:
    if specifier.startswith("."):
        return posixpath.normpath(posixpath.join(posixpath.dirname(importer), specifier))
    return _VENDORED.get(specifier)


def _data_url(source: str) -> str:
    return "data:text/javascript;base64," + base64.b64encode(source.encode()).decode()


def _text(path: str) -> str:
    return (SOURCES / path).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
