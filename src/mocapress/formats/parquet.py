"""Apache Parquet: a table of columns for data frames; needs the extra ``parquet``."""

import json

from mocapress.errors import UnsupportedError
from mocapress.formats.contract import Format
from mocapress.formats.table_writing import counted, files, with_frames
from mocapress.motion import Clip, Stream


def write(clip: Clip) -> dict[str, bytes]:
    """Give a file for each stream, of the columns frame, time, and one for each channel.

    Numbers are float64; NaN stays NaN. Fields have their unit as metadata, the file the clip's.

    Raises
    ------
    UnsupportedError
        Where pyarrow is not installed.

    """
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError as error:
        raise UnsupportedError(
            "writing Parquet needs pyarrow", expected="pip install 'mocapress[parquet]'"
        ) from error

    def of_stream(stream: Stream) -> bytes:
        count = counted(clip, stream)
        fields = [pa.field("frame", pa.int64())]
        arrays = [pa.array(count.frame)]
        if count.time is not None:
            fields.append(pa.field("time", pa.float64(), metadata={"unit": "s"}))
            arrays.append(pa.array(count.time))
        for column, numbers in zip(stream.columns, stream.values.T, strict=True):
            fields.append(pa.field(column.name, pa.float64(), metadata={"unit": column.unit}))
            arrays.append(pa.array(numbers))
        facts = {"name": clip.name, "frame_time": str(stream.frame_time), **clip.metadata}
        table = pa.table(arrays, schema=pa.schema(fields, {"mocapress": json.dumps(facts)}))
        sink = pa.BufferOutputStream()
        parquet.write_table(table, sink, compression="zstd")
        return bytes(sink.getvalue())

    return files(".parquet", clip, of_stream)


FORMAT = Format(
    id="parquet",
    name="Parquet",
    suffixes=(".parquet",),
    recognises=lambda _: False,
    fit=with_frames,
    write=write,
    any_columns=True,
    timed=False,
)
