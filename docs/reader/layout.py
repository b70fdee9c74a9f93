"""From numbers to the original file (docs/format/layout.md)."""

from dataclasses import dataclass

from container import File, Stream
from printing import padded, printed
from records import CorruptError, Record, unzigzag

WORDS = {
    **{f"t{axis}": f"{axis.upper()}position" for axis in "xyz"},
    **{f"r{axis}": f"{axis.upper()}rotation" for axis in "xyz"},
    **{f"s{axis}": f"{axis.upper()}scale" for axis in "xyz"},
}
LITERAL, BREAK, NAME, CHANNELS, COUNT, TIME, PASS, VALUE = range(8)
NUMBER, TEXT = 0x10, 0x20


@dataclass
class Template:
    """The pattern of some rows."""

    pattern: bytes
    columns: list[int]
    widths: bytes
    counter_width: int


class Layout:
    """A file without its numbers."""

    def __init__(self, file: File, frames: int) -> None:
        self.file, self.stream = file, file.streams[0]
        record, columns = Record(file.layout), len(self.stream.formats)
        flags = record.integer()
        self.encoding = "utf-8" if flags & 2 else "iso8859-1"
        self.of_file = {0: "", 4: "utf-16-le", 8: "utf-16-be"}[flags & 12]
        self.line_break, self.indentation = record.bytes(), record.bytes()
        self.header_formats = [record.raw(4) for _ in range(record.integer())]
        self.header_pattern, self.tail = record.bytes(), record.bytes()
        self.templates = [read_template(record, columns) for _ in range(record.integer())]
        self.assigned = record.list_in_runs(frames)
        steps = record.list_in_runs(frames) if flags & 1 else [0] * frames
        self.numbers = [sum(map(unzigzag, steps[: f + 1])) for f in range(frames)]
        self.written: dict[tuple[int, int], bytes] = {}
        row = 0
        for _ in range(record.integer()):
            row += record.integer()
            place = record.integer()
            self.written[row, place] = record.bytes()
        self.verbatim = [record.bytes() for code in self.assigned if code == 0]
        record.end()

    def printed(self, rows: list[list[float]]) -> bytes:
        """Print the file."""
        verbatim = iter(self.verbatim)
        body = b""
        for f, (row, code) in enumerate(zip(rows, self.assigned, strict=True)):
            body += self._row(f, row, self.templates[code - 1]) if code else next(verbatim)
        file = self._header(len(rows)) + body + self.tail
        return ("\ufeff" + file.decode()).encode(self.of_file) if self.of_file else file

    def _header(self, frames: int) -> bytes:
        out = bytearray()
        joints = iter(self.file.joints)
        numbers = iter([number for joint in self.file.joints for number in joint.numbers])
        channels: list[str] = []
        pattern = iter(enumerate(self.header_pattern))
        for at, byte in pattern:
            if byte >= TEXT or byte in b"\t\n\r":
                out.append(byte)
            elif byte >= NUMBER:
                out += printed(next(numbers), self.header_formats[byte - NUMBER]).encode()
            elif byte == LITERAL:
                out.append(next(pattern)[1])
            elif byte == BREAK:
                closes = self.header_pattern[at + 1 : at + 2] == b"}"
                depth = max(out.count(b"{") - out.count(b"}"), 0) - closes
                out += self.line_break + self.indentation * depth
            elif byte == NAME:
                joint = next(joints)
                channels = joint.channels
                out += joint.name.encode(self.encoding)
            elif byte == CHANNELS:
                out += " ".join([str(len(channels)), *(WORDS[c] for c in channels)]).encode()
            elif byte == COUNT:
                out += str(frames).encode()
            elif byte == TIME:
                out += decimal(self.stream).encode()
            elif byte == PASS:
                next(numbers)
            else:
                raise CorruptError("a header of unknown pattern")
        return bytes(out)

    def _row(self, f: int, row: list[float], template: Template) -> bytes:
        out = bytearray()
        place = 0
        pattern = iter(template.pattern)
        for byte in pattern:
            if byte >= TEXT or byte in b"\t\n\r":
                out.append(byte)
            elif byte == LITERAL:
                out.append(next(pattern))
            elif byte == BREAK:
                out += self.line_break
            elif byte == NAME:
                out += self.stream.bones[template.columns[place]].encode(self.encoding)
            elif byte == COUNT:
                out += f"{self.numbers[f]:0{template.counter_width}d}".encode()
            elif byte == VALUE:
                column = template.columns[place]
                text = self.written.get((f, place))
                if text is None:
                    told = self.stream.formats[column] or bytes([4, 0, 2, 0])
                    text = padded(row[column], told, template.widths[place]).encode()
                out += text
                place += 1
            else:
                raise CorruptError("a row of unknown pattern")
        return bytes(out)


def read_template(record: Record, columns: int) -> Template:
    """Take a template of rows."""
    flags, pattern = record.integer(), record.bytes()
    own, column = list(range(columns)), -1
    if flags & 1:
        own = []
        for _ in range(record.integer()):
            column += 1 + record.signed()
            own.append(column)
    widths = record.raw(len(own)) if flags & 2 else bytes(len(own))
    return Template(pattern, own, widths, record.raw(1)[0] if flags & 4 else 0)


def decimal(stream: Stream) -> str:
    """Print the frame time."""
    if stream.frame_time is None:
        raise CorruptError("a frame time that is no decimal")
    digits, exponent = str(stream.frame_time[0]), stream.frame_time[1]
    if exponent >= 0:
        return digits + "0" * exponent
    digits = digits.rjust(1 - exponent, "0")
    return f"{digits[:exponent]}.{digits[exponent:]}"
