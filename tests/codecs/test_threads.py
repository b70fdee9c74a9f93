"""Work on all processors comes back in order, and fails as it would one after the other."""

import pytest

from mocapress.codecs import threads


@pytest.mark.parametrize("processors", [1, 3])
def test_each_keeps_the_order_and_the_first_error(
    processors: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(threads, "processors", lambda: processors)
    assert threads.each(str, range(50)) == [str(i) for i in range(50)]
    assert threads.each(str, []) == []

    def fail(i: int) -> None:
        if i >= 3:
            raise ValueError(i)

    with pytest.raises(ValueError, match=r"^3$"):
        threads.each(fail, range(50))


def test_there_is_at_least_one_processor() -> None:
    assert threads.processors() >= 1
