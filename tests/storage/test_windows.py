"""What Windows lacks: locks on files, renaming what is open, owners, reading at a place."""

import os
from pathlib import Path

import pytest

import mocapress as mp
from mocapress import storage


@pytest.fixture(autouse=True)
def lacking(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take it away from this system, and keep its rule for renaming."""
    monkeypatch.setattr(storage, "LOCKS", False)
    monkeypatch.delattr(os, "pread")
    monkeypatch.delattr(os, "fchown")
    replace = Path.replace

    def unless_open(self: Path, target: Path) -> Path:
        opened = {
            link.resolve() for link in Path("/proc/self/fd").iterdir() if os.path.lexists(link)
        }
        if self.resolve() in opened:
            raise PermissionError(13, "Access is denied", str(self))
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", unless_open)


def test_files_are_new_or_replaced_or_left(tmp_path: Path) -> None:
    pair = [tmp_path / "walk.amc", tmp_path / "walk.asf"]
    storage.write_all(dict.fromkeys(pair, b"one"))
    with pytest.raises(storage.ExistsError):
        storage.write_all(dict.fromkeys(pair, b"two"))
    assert [path.read_bytes() for path in pair] == [b"one", b"one"]
    storage.write_all(dict.fromkeys(pair, b"two"), force=True, like=pair[0].stat())
    assert [path.read_bytes() for path in pair] == [b"two", b"two"]
    assert sorted(tmp_path.iterdir()) == pair


def test_a_failure_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        storage.write_whole(tmp_path / "a", b"one")
    assert not list(tmp_path.iterdir())


def test_a_part_of_a_file_is_read(tmp_path: Path, samples: Path) -> None:
    packed = tmp_path / "walk.mcz"
    packed.write_bytes(mp.compress(samples / "cmu_01_01.amc"))
    clip = mp.load(packed, frames=slice(700, 703))
    assert (clip.values == mp.read(samples / "cmu_01_01.amc").values[700:703]).all()
