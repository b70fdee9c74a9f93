"""How long the page needs to open a long clip: from navigation to the first frame on the screen.

    python benchmarks/page_opening.py [FRAMES]

Repeats the CMU sample to 20,000 frames, embeds it both ways, and opens each page in Chromium with
software rendering, as the tests do. Also says how long the page was busy at a stretch meanwhile,
and what load the machine had, on which these times depend; and how much processor time the worker's
part takes (benchmarks/page_reading.mjs), which hardly depends on it.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import mocapress as mp
from mocapress.viewer import embed, page

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests/viewer"))
from browsing import chromium  # noqa: E402

SHOWN = "performance.getEntriesByName('first frame')[0]?.startTime ?? 0"
WATCH = """
window.longest = 0;
new PerformanceObserver((list) => {
    for (const { duration } of list.getEntries()) window.longest = Math.max(longest, duration);
}).observe({ type: "longtask", buffered: true });
"""


def main(frames: int) -> None:
    clip = mp.read(ROOT / "samples/cmu_01_01.amc")
    rows = np.resize(np.arange(clip.frames), frames)
    clip = clip.with_frames(clip.values[rows], clip.frame_time)
    made = {"exact": embed.exact(clip), "diffma": embed.approximate(clip, 0.01)}
    if node := shutil.which("node"):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "exact.mcz"
            file.write_bytes(mp.compress(clip))
            script = ROOT / "benchmarks/page_reading.mjs"
            subprocess.run([node, script, file], check=True)
    with chromium() as browser, tempfile.TemporaryDirectory() as folder:
        for way, content in made.items():
            file = Path(folder) / f"{way}.html"
            file.write_text(page.document([content], assets=embed.assets([content])))
            times, busy = [], []
            for _ in range(5):
                tab = browser.new_page(viewport={"width": 1280, "height": 800})
                tab.add_init_script(WATCH)
                tab.goto(file.as_uri())
                while not tab.evaluate(SHOWN):
                    time.sleep(0.02)
                times.append(tab.evaluate(SHOWN) / 1000)
                busy.append(tab.evaluate("longest") / 1000)
                tab.close()
            size = file.stat().st_size / 1e6
            print(
                f"{way}: {frames} frames, {size:.1f} MB, median {np.median(times):.2f} s, "
                f"busy at a stretch {np.median(busy):.2f} s; "
                f"times {[round(seconds, 2) for seconds in times]}, "
                f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
            )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20_000)
