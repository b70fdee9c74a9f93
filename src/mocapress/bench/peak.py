"""Prints the peak memory of this process, MB, before and after it codes a file."""

import re
import sys
from pathlib import Path

from mocapress.bench.contenders import codec_contenders, tool_contenders
from mocapress.formats.files import sniff, split


def _peak() -> float:
    # Not getrusage: its maximum is handed down from the process that started this one.
    status = Path("/proc/self/status").read_text()
    found = re.search(r"VmHWM:\s*(\d+) kB", status)
    return int(found[1]) / 1024 if found else 0.0


def main(path: Path, contender: str) -> None:
    """Code one file with one contender, both ways."""
    codecs, (tools, _) = codec_contenders(), tool_contenders()
    data = path.read_bytes()
    before = _peak()
    if contender in codecs:
        made = codecs[contender]
        clip, layout, _ = split(data, sniff(data, path.name) or "")
        encoded = made.encode(clip)
        layout.join(made.decode(encoded.header, encoded.chunks, clip.columns))
    else:
        tools[contender].decompress(tools[contender].compress(data))
    print(before, _peak())


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
