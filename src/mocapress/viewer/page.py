"""The page as one document: markup, style, scripts and motion. It fetches nothing.

The scripts are modules that import each other by relative paths. The document holds them packed,
each after those that it imports, and ``page/start.js`` gives each a ``blob:`` URL. So checkout,
tests and document use the same files, without a bundler.
"""

import base64
import gzip
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
_START = "page/start.js"
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
        Title of the browser's window.

    Returns
    -------
    str
        HTML. Its policy (``policy``) allows no requests at all.

    """
    # In a script element only "<" can end the text early or begin a comment.
    motion = json.dumps({"clips": clips}, separators=(",", ":")).replace("<", "\\u003c")
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy()}">\n'
        f"<title>{_escaped(title)}</title>\n<style>{_text('page/style.css')}</style>"
    )
    body = (
        f'<script type="application/json" id="clips">{motion}</script>\n'
        f'<script type="application/gzip" id="modules">{_packed_modules()}</script>\n'
        f'<script type="module">{_text(_START)}</script>\n'
        f"<!--\n{_text('vendor/three/LICENSE')}-->"
    )
    markup = _text("page/index.html")
    return markup.replace("<!-- head -->", head).replace("<!-- body -->", body)


def policy() -> str:
    """Give the content security policy: only the page's own scripts and style, no connections."""
    return (
        f"default-src 'none'; script-src {_digest(_text(_START))} blob:; "
        f"style-src {_digest(_text('page/style.css'))}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _packed_modules() -> str:
    """Give a JSON list of [path, source] in gzip and base64."""
    text = json.dumps(list(modules().items())).encode()
    return base64.b64encode(gzip.compress(text, mtime=0)).decode()


def modules() -> dict[str, str]:
    """Give the page's modules by their paths, each after all that it imports.

    Imports name the paths, as ``"module:page/app.js"``.
    """
    done: dict[str, str] = {}
    begun: set[str] = set()

    def add(path: str) -> None:
        def named(match: re.Match[str]) -> str:
            target = _target(path, match[3])
            if target is None or (target in begun and target not in done):
                return match[0]  # a comment's: there are no cycles
            if target not in done:
                add(target)
            return f'{match[1]}"module:{target}"'

        begun.add(path)
        source = _IMPORT.sub(named, _text(path))
        done[path] = f"{source}\n//# sourceURL=mocapress/{path}\n"

    add(_MAIN)
    return done


def _target(importer: str, specifier: str) -> str | None:
    if specifier.startswith("."):
        return posixpath.normpath(posixpath.join(posixpath.dirname(importer), specifier))
    return _VENDORED.get(specifier)


def _text(path: str) -> str:
    return (SOURCES / path).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
