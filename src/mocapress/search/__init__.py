"""Search by example: which clips, or which stretches of them, are like a given one."""
