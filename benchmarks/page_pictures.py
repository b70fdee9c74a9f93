"""Takes the README's pictures of the page, docs/images/view_*.jpg, in Chromium.

python benchmarks/page_pictures.py
"""

import sys
import tempfile
from pathlib import Path

import mocapress as mp
from mocapress.viewer import embed, page

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests/viewer"))
from browsing import Visit, chromium  # noqa: E402

IMAGES = ROOT / "docs/images"


def main() -> None:
    sample = ROOT / "samples/cmu_01_01.amc"
    with chromium() as browser, tempfile.TemporaryDirectory() as folder:
        decoded = Path(folder) / "cmu_01_01.diffma.json"
        decoded.write_bytes(mp.to_json(sample, "diffma:bound=64"))
        document = page.document([embed.file(sample), embed.file(decoded)])
        sizes = {"laptop": (1280, 800, "dark"), "phone": (390, 844, "light")}
        for name, (width, height, scheme) in sizes.items():
            tab = browser.new_page(
                viewport={"width": width, "height": height},
                color_scheme=scheme,
                is_mobile=name == "phone",
                has_touch=name == "phone",
            )
            visit = Visit(tab)
            visit.open(document, Path(folder))
            if name == "phone":
                tab.keyboard.press("o")
            visit.seek(0)
            for _ in range(4):
                tab.keyboard.press("Shift+ArrowRight")
            visit.pixels()
            tab.screenshot(path=IMAGES / f"view_{name}.jpg", type="jpeg", quality=88)
            tab.close()


if __name__ == "__main__":
    main()
