"""Lines that compare the sizes of originals and compressed files."""

from mocapress.cli.batch import STREAM, Job


def show_sizes(job: Job) -> None:
    """Print a line for a file that was written."""
    if job.target == STREAM:
        return
    lost, errors = job.result.get("largest_error"), ""
    if lost is not None:
        errors = f"; lossy: largest error {lost:.3g}, mean {job.result['mean_error']:.3g}"
        if job.result["psnr"] is not None:
            errors += f", PSNR {job.result['psnr']:.1f} dB"
        centimetres = job.result["centimetres_per_unit"]
        by, unit = (centimetres, "cm") if centimetres else (1.0, "units of length")
        for point in ("joint", "marker"):
            if (most := job.result[f"largest_{point}_error"]) is not None:
                errors += f"; {point}s off by up to {most * by:.3g} {unit}"
        parts = job.result["largest_joint_error_of"]
        errors += "".join(f", {part} by {most * by:.3g} {unit}" for part, most in parts.items())
    print(f"{job.target}: {_sizes([job])}{errors}")


def show_total(jobs: list[Job]) -> None:
    """Print a line for all of them."""
    print(f"{len(jobs)} files: {_sizes(jobs)}")


def _sizes(jobs: list[Job]) -> str:
    raw = sum(job.result["raw_bytes"] for job in jobs)
    small = sum(job.result["compressed_bytes"] for job in jobs)
    return f"{raw} <-> {small} bytes, {raw / small:.2f} : 1"
