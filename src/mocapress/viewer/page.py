"""The page as one document: markup, style, scripts, decoders and motion. It fetches nothing.

The scripts are modules that import each other by relative paths. The document holds them packed,
each after those that it imports, and ``page/start.js`` gives each a ``blob:`` URL. So checkout,
tests and document use the same files, without a bundler. The decoders are the core as WebAssembly,
one file a codec.
"""

import base64
import gzip
import hashlib
import json
import posixpath
import re
from collections.abc import Collection, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from mocapress.viewer.server import Answer

# A wheel carries the sources beside this module; a checkout has them in its folder viewer/.
_PACKAGED = Path(__file__).with_name("web")
SOURCES = _PACKAGED if _PACKAGED.is_dir() else Path(__file__).parents[3] / "viewer"

_MAIN = "page/main.js"
_WORKER = "page/work/worker.js"
_START = "page/start.js"
_VENDORED = {
    "three": "vendor/three/three.module.min.js",
    "three/addons/controls/OrbitControls.js": "vendor/three/OrbitControls.js",
}
_DICTIONARY = "dictionary1.bin"
_CONNECT = "connect-src 'self'; "
_XZ = "vendor/xz/xz.wasm"
_KINEMATICS = "wasm/kinematics.wasm"
_COMMENT = re.compile(r"^[ \t]*(/\*\*\n.*?\*/|/\*\* .*?\*/|//.*?)\n", re.MULTILINE | re.DOTALL)
"""Comments on lines of their own, which only developers need; licences stand in the document."""
_INDENT = re.compile(r"^[ \t]+", re.MULTILINE)
_LENT = {
    "/vendor/sqlite/sqlite3.mjs": "text/javascript",
    "/vendor/sqlite/sqlite3.wasm": "application/wasm",
}
_IMPORT = re.compile(r"""(\b(?:from|import)\s*)(["'])([^"'\n]+)\2""")


def document(
    clips: Sequence[dict[str, Any]],
    title: str = "mocapress",
    *,
    assets: Collection[str] | None = None,
    served: bool = False,
    library: str | None = None,
) -> str:
    """Give the page that plays these clips.

    Parameters
    ----------
    clips
        As ``embed`` makes them.
    title
        Title of the browser's window.
    assets
        The binary files that the page carries, of ``asset_names``; None carries all, so that it
        plays every file that is dropped on it.
    served
        Whether the page comes from a ``PageServer``, of which it may ask for more.
    library
        Name of the library that the server offers.

    Returns
    -------
    str
        HTML. Its policy (``policy``) allows no requests, but those to its server where it has one.

    """
    # In a script element only "<" can end the text early or begin a comment.
    motion = json.dumps({"clips": clips}, separators=(",", ":")).replace("<", "\\u003c")
    head = (
        f'<meta http-equiv="Content-Security-Policy" content="{policy(served=served)}">\n'
        f"{_about(served=served, library=library)}"
        f"<title>{_escaped(title)}</title>\n<style>{_text('page/style.css')}</style>"
    )
    carried = binary_files(asset_names() if assets is None else assets)
    vendored = ["three", "xz"] if _XZ in carried else ["three"]
    licences = "\n".join(_text(f"vendor/{name}/LICENSE") for name in vendored)
    code = _packed(_json([*modules().items()]))
    files = _packed(_one_behind_the_other(carried))
    body = (
        f'<script type="application/json" id="clips">{motion}</script>\n'
        f'<script type="application/gzip" id="modules">{code}</script>\n'
        f'<script type="application/gzip" id="assets">{files}</script>\n'
        f'<script type="module">{_text(_START)}</script>\n'
        f"<!--\n{licences}-->"
    )
    markup = _text("page/index.html")
    return markup.replace("<!-- head -->", head).replace("<!-- body -->", body)


def policy(*, served: bool = False) -> str:
    """Give the content security policy: only the page's own scripts and style.

    There are no connections, but to the server of a page that is served.
    """
    return (
        f"default-src 'none'; script-src {_digest(_text(_START))} blob: 'wasm-unsafe-eval'; "
        f"{_CONNECT if served else ''}worker-src blob:; "
        f"style-src {_digest(_text('page/style.css'))}; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def asset_names() -> list[str]:
    """Give the names of the binary files that reading may need: decoders, and a dictionary."""
    wasm = sorted(path.name for path in (SOURCES / "wasm").glob("*.wasm"))
    return [_DICTIONARY, _XZ, *(f"wasm/{name}" for name in wasm)]


def assets_for(codecs: Collection[str], methods: Collection[int]) -> list[str]:
    """Give the names of the binary files that some files need.

    Parameters
    ----------
    codecs
        Ids of their codecs.
    methods
        By which their heads are packed: docs/format.md, "Packed content".

    """
    needed = {_KINEMATICS, *(f"wasm/{codec}.wasm" for codec in codecs)}
    if 1 in methods or "diffma" in codecs:
        needed.add(_XZ)
    if 2 in methods:
        needed.add(_DICTIONARY)
    return [name for name in asset_names() if name in needed]


def lent(path: str) -> Answer | None:
    """Give SQLite to the page, which asks for it where a library is dropped on it."""
    kind = _LENT.get(path)
    return None if kind is None else Answer((SOURCES / path[1:]).read_bytes(), kind)


def binary_files(names: Collection[str]) -> dict[str, bytes]:
    """Give the contents of binary files."""
    container = resources.files("mocapress.container")
    made = {}
    for name in names:
        file = container.joinpath(name) if name == _DICTIONARY else SOURCES / name
        made[name] = file.read_bytes()
    return made


def _one_behind_the_other(files: dict[str, bytes]) -> bytes:
    """Give names and sizes in a line of JSON, and then the files; ``page/start.js`` reads them."""
    sizes = [(name, len(data)) for name, data in files.items()]
    return b"\n".join([_json(sizes), b"".join(files.values())])


def _json(content: Any) -> bytes:
    return json.dumps(content).encode()


def _packed(content: bytes) -> str:
    """Give bytes in gzip and base64."""
    return base64.b64encode(gzip.compress(content, mtime=0)).decode()


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
        text = _text(path)
        if not path.startswith("vendor/"):
            text = _INDENT.sub("", _COMMENT.sub("", text))
        source = _IMPORT.sub(named, text)
        done[path] = f"{source}\n//# sourceURL=mocapress/{path}\n"

    add(_MAIN)
    add(_WORKER)
    return done


def _target(importer: str, specifier: str) -> str | None:
    if specifier.startswith("."):
        return posixpath.normpath(posixpath.join(posixpath.dirname(importer), specifier))
    return _VENDORED.get(specifier)


def _text(path: str) -> str:
    return (SOURCES / path).read_text(encoding="utf-8")


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _about(*, served: bool, library: str | None) -> str:
    """Say whom the page may ask, and for what."""
    parts = ['<meta name="served" content="">\n'] if served else []
    if library is not None:
        parts.append(f'<meta name="library" content="{_escaped(library)}">\n')
    return "".join(parts)


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
