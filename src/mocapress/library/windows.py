"""Windows of a library's clips, as data sets for machine learning take them."""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import DTypeLike, NDArray

from mocapress.errors import ParameterError
from mocapress.motion import Clip
from mocapress.motion.kinematics import positions, rotations

if TYPE_CHECKING:
    from mocapress.library.reading import Reading

VALUES, POSITIONS, ROTATIONS = "values", "positions", "rotations"


class Windows:
    """All windows of so many successive frames of clips: ``len``, integers and slices.

    What ``torch.utils.data.DataLoader`` calls a map-style data set, also with workers: each
    opens the library itself. A window is decoded when it is asked for.

    Parameters
    ----------
    library
        The library; clips that are added later do not count.
    frames, stride
        Of a window, and from the beginning of one to that of the next.
    of
        ``"values"``: (n, C); ``"positions"``: of the joints, (n, J, 3); ``"rotations"``: relative
        to the parents, (n, J, 6), the first two columns of each rotation's matrix (Zhou et al.,
        On the Continuity of Rotation Representations in Neural Networks, 2019).
    columns
        Names or globs of columns, for values.
    dtype
        Of the arrays.
    glob, label, skeleton
        Which clips, as in ``Library.clips``. To be stacked, windows must have the same joints.

    """

    def __init__(
        self,
        library: "Reading",
        frames: int,
        *,
        stride: int | None = None,
        of: str = VALUES,
        columns: Sequence[str] | None = None,
        dtype: DTypeLike = np.float32,
        glob: str | Iterable[str] = (),
        label: str | None = None,
        skeleton: str | None = None,
    ) -> None:
        for name, value in (("frames", frames), ("stride", stride or frames)):
            if value < 1:
                raise ParameterError(name, expected="at least 1", found=str(value))
        if of not in (VALUES, POSITIONS, ROTATIONS):
            expected = f"{VALUES}, {POSITIONS} or {ROTATIONS}"
            raise ParameterError("of", expected=expected, found=repr(of))
        if columns is not None and of != VALUES:
            raise ParameterError("columns are for values", found=f"of={of!r}")
        self.library, self.frames, self.stride = library, frames, stride or frames
        self.of, self.columns, self.dtype = of, columns, np.dtype(dtype)
        found = [
            clip
            for clip in library.clips(glob, label=label, skeleton=skeleton)
            if clip.frames >= frames
        ]
        self._clips = [clip.id for clip in found]
        counts = ((clip.frames - frames) // self.stride + 1 for clip in found)
        self._ends = [*accumulate(counts)]

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @overload
    def __getitem__(self, index: int) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, index: slice) -> list[NDArray[Any]]: ...
    def __getitem__(self, index: int | slice) -> NDArray[Any] | list[NDArray[Any]]:
        """Give a window, or the windows of a slice.

        Raises
        ------
        IndexError
            When there are fewer.

        """
        if isinstance(index, slice):
            return [self._window(i) for i in range(len(self))[index]]
        return self._window(range(len(self))[index])

    def where(self, index: int) -> tuple[int, int]:
        """Give the id of a window's clip, and the window's first frame."""
        number = range(len(self))[index]
        clip = bisect_right(self._ends, number)
        before = self._ends[clip - 1] if clip else 0
        return self._clips[clip], (number - before) * self.stride

    def _window(self, index: int) -> NDArray[Any]:
        number, first = self.where(index)
        frames = slice(first, first + self.frames)
        clip = self.library.load(number, frames, columns=self.columns)
        return self._taken(clip).astype(self.dtype)

    def _taken(self, clip: Clip) -> NDArray[np.float64]:
        if self.of == POSITIONS:
            return positions(clip)
        if self.of == ROTATIONS:
            return rotations(clip, local=True, form="6d")
        return clip.values
