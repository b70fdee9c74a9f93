"""The lookup tables of alpha (the paper's Table 1)."""

ALPHA_TABLES: dict[str, tuple[float, ...]] = {
    "k2-non-uniform": (-2, -0.5, 0, 0.5),
    "k3-uniform": (-1.75, -1.25, -0.75, -0.25, 0.25, 0.75, 1.25, 1.75),
    "k3-non-uniform": (-1, -0.5, -0.25, 0, 0.25, 0.5, 1, 2),
    # The paper prints 0.25 twice; by its order the first is -0.25.
    "k4-non-uniform": (
        *(-2, -1.25, -1, -0.75, -0.5, -0.25, -0.125, 0),
        *(0.125, 0.25, 0.5, 0.75, 1, 1.25, 2, 5),
    ),
}
"""Name -> the 2^k values that k bits choose from."""
