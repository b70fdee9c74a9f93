"""Joints and parts of the body that have bounds of their own."""

import re
from collections.abc import Mapping

from mocapress.errors import ParameterError
from mocapress.motion import Skeleton
from mocapress.motion.standard_joints import by_names
from mocapress.motion.units import Amount, amount

_SIDED = {"hand": "wrist", "arm": "shoulder", "foot": "ankle", "leg": "hip"}
_PLURALS = {"hands": "hand", "arms": "arm", "feet": "foot", "legs": "leg"}
_TOPS = (
    {"head": ("head",)}
    | {
        f"{side}{part}": (f"{side}_{top}",)
        for side in ("left", "right")
        for part, top in _SIDED.items()
    }
    | {many: (f"left_{_SIDED[one]}", f"right_{_SIDED[one]}") for many, one in _PLURALS.items()}
)
"""The standard joints at which parts of the body begin."""


def amounts(text: str) -> dict[str, Amount]:
    """Read ``feet=0.02cm,lefthand=1mm``: names -> amounts.

    Raises
    ------
    ParameterError
        When an item is no name and amount, or a name comes twice.

    """
    found: dict[str, Amount] = {}
    for item in filter(None, text.split(",")):
        name, _, value = item.rpartition("=")
        if not name or name in found:
            raise ParameterError(
                "near: bounds of parts", expected="each once, such as feet=0.02cm", found=repr(item)
            )
        what = f"codec near has no such parameter, and no bound of a part of the body: {name}"
        found[name] = amount(value, what)
    return found


def joints_of_parts(skeleton: Skeleton, names: Mapping[str, object]) -> dict[str, list[int]]:
    """Give the joints that each name stands for, as indices into the skeleton.

    The name of a joint stands for that joint. That of a part of the body stands for the joint at
    which the part begins and all below it.

    Raises
    ------
    ParameterError
        When a name is neither, or this skeleton's names do not say where the part is.

    """
    return {name: _joints(skeleton, name) for name in names}


def _joints(skeleton: Skeleton, name: str) -> list[int]:
    if name in skeleton.names:
        return [skeleton.index(name)]
    known = by_names(skeleton)
    tops = _TOPS.get(re.sub("[^a-z]", "", name.lower()), ())
    if not tops or any(top not in known for top in tops):
        what = (
            "the names of joints do not say where it is"
            if tops
            else "no such parameter, part or joint"
        )
        raise ParameterError(
            f"near:{name}: {what}",
            expected=f"one of {', '.join(_TOPS)}, or a joint or marker of {_some(skeleton.names)}",
            found=name,
        )
    within = {known[top] for top in tops}
    for index, joint in enumerate(skeleton.joints):
        if joint.parent in within:
            within.add(index)
    return sorted(within)


def _some(names: tuple[str, ...]) -> str:
    return ", ".join(names[:8]) + (" ..." if len(names) > 8 else "")
