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
_XZ = "vendor/xz/xz.wasm"
_KINEMATICS = "wasm/kinematics.wasm"
_COMMENT = re.compile(r"^[ \t]*(/\*\*\n.*?\*/|/\*\* .*?\*/|//.*?)\n", re.MULTILINE | re.DOTALL)
"""Comments on lines of their own, which only developers need; licences stand in the document."""
_IMPORT = re.compile(r"""(\b(?:from|import)\s*)(["'])([^"'\n]+)\2""")


def document(
    clips: Sequence[dict[str, Any]],
    title: str = "mocapress",
    *,
    assets: Collection[str] | None = None,
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
    carried = encoded(asset_names() if assets is None else assets)
    vendored = ["three", "xz"] if _XZ in carried else ["three"]
    licences = "\n".join(_text(f"vendor/{name}/LICENSE") for name in vendored)
    body = (
        f'<script type="application/json" id="clips">{motion}</script>\n'
        f'<script type="application/gzip" id="modules">{_packed([*modules().items()])}</script>\n'
        f'<script type="application/gzip" id="assets">{_packed(carried)}</script>\n'
        f'<script type="module">{_text(_START)}</script>\n'
        f"<!--\n{licences}-->"
    )
    markup = _text("page/index.html")
    return markup.replace("<!-- head -->", head).replace("<!-- body -->", body)


def policy() -> str:
    """Give the content security policy: only the page's own scripts and style, no connections."""
    return (
        f"default-src 'none'; script-src {_digest(_text(_START))} blob: 'wasm-unsafe-eval'; "
        "worker-src blob:; "
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


def encoded(names: Collection[str]) -> dict[str, str]:
    """Give binary files in base64."""
    container = resources.files("mocapress.container")
    made = {}
    for name in names:
        file = container.joinpath(name) if name == _DICTIONARY else SOURCES / name
        made[name] = base64.b64encode(file.read_bytes()).decode()
    return made


def _packed(content: Any) -> str:
    """Give JSON in gzip and base64."""
    text = json.dumps(content).encode()
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
        source = _IMPORT.sub(named, _COMMENT.sub("", _text(path)))
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


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
