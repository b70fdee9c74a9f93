"""A page in Debian's Chromium: what it shows, what it logs, what it asks for."""

import base64
import io
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray
from playwright.sync_api import Browser, ConsoleMessage, Page, Request, sync_playwright

# Software rendering, and nothing of its own sent anywhere.
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
LAPTOP = (1280, 800)
PHONE = (390, 844)
PATIENCE = 60.0
"""Seconds, on a machine that does much else."""

DROP = """([files, zone]) => {
    const transfer = new DataTransfer();
    for (const [name, content] of files) {
        const bytes = Uint8Array.from(atob(content), (c) => c.charCodeAt(0));
        transfer.items.add(new File([bytes], name));
    }
    const target = zone ? document.querySelector(`[data-drop=${zone}]`) : document.body;
    for (const type of ["dragenter", "dragover", "drop"]) {
        const init = {bubbles: true, cancelable: true, dataTransfer: transfer};
        target.dispatchEvent(new DragEvent(type, init));
    }
}"""


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start the browser; it ends with the block."""
    path = shutil.which("chromium")
    if path is None:
        reason = (
            "no chromium (Debian: apt-get install chromium); `make browser` installs it as root"
        )
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        try:
            yield browser
        finally:
            browser.close()


class Visit:
    """A page that is open, with all that it logged and asked for."""

    def __init__(self, page: Page) -> None:
        self.page = page
        page.set_default_timeout(PATIENCE * 1000)
        self.logged: list[str] = []
        self.asked: list[str] = []
        page.on("console", self._log)
        page.on("pageerror", lambda error: self.logged.append(str(error)))
        page.on("request", self._ask)

    def _log(self, message: ConsoleMessage) -> None:
        # The driver's remark on screenshots is not the page's.
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.logged.append(message.text)

    def _ask(self, request: Request) -> None:
        if not request.url.startswith(("data:", "blob:")):
            self.asked.append(request.url)

    def open(self, document: str, folder: Path) -> None:
        """Open a document from disk."""
        file = folder / "page.html"
        file.write_text(document)
        self.page.goto(file.as_uri())
        self.until("document.body.classList.contains('empty') || document.body.dataset.frame")

    def until(self, expression: str) -> None:
        """Wait until an expression of the page is true; the page forbids to evaluate in itself."""
        end = time.monotonic() + PATIENCE
        while not self.page.evaluate(expression):
            assert time.monotonic() < end, expression
            time.sleep(0.02)

    @property
    def frame(self) -> int:
        """Number of the frame that is shown, from 0."""
        return int(self.page.evaluate("document.body.dataset.frame"))

    def seek(self, frame: int) -> None:
        """Pause at a frame, by the keyboard."""
        self.page.evaluate("document.activeElement.blur()")
        self.page.keyboard.press("ArrowLeft")  # a step pauses
        self.page.keyboard.press("Home")
        # Hundreds of keys one by one take the driver a minute.
        self.page.evaluate(
            """(count) => {
                const step = { key: "ArrowRight", bubbles: true };
                for (let i = 0; i < count; i++)
                    document.body.dispatchEvent(new KeyboardEvent("keydown", step));
            }""",
            frame,
        )

    def pixels(self) -> NDArray[np.float32]:
        """Give the canvas as it is on the screen: (H, W, 3), 0 to 1."""
        self.page.evaluate(
            "new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50)))"
        )
        picture = self.page.locator(".view").screenshot()
        made: NDArray[np.float32] = imread(io.BytesIO(picture))[..., :3]
        return made

    def drop(self, *files: Path | tuple[str, bytes], zone: str = "") -> None:
        """Drop files on the page."""
        named = [(f.name, f.read_bytes()) if isinstance(f, Path) else f for f in files]
        encoded = [(name, base64.b64encode(data).decode()) for name, data in named]
        self.page.evaluate(DROP, [encoded, zone])

    def text(self, selector: str) -> str:
        """Give what an element says."""
        return self.page.locator(selector).inner_text()

    def names(self) -> Any:
        """Give the clips' names as the page's head lists them."""
        return self.page.locator("#legend b").all_inner_texts()


def coloured(pixels: NDArray[np.float32], strong: int) -> int:
    """Count pixels whose channel (0 red, 1 green, 2 blue) stands out."""
    others = np.delete(pixels, strong, axis=-1).max(axis=-1)
    return int((pixels[..., strong] > others + 0.15).sum())
