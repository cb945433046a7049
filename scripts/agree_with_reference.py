#!/usr/bin/env python3
"""Renders a scene with Lampyris, and compares it with a picture of it that another renderer made.

    pip install mitsuba
    python scripts/agree_with_reference.py SCENE REFERENCE.exr [--integrator path] [--passes 64] [--runs 4]

Blocks of 8 x 8 pixels of the reference are compared with single pixels (box filter) of `--runs` renders with different
seeds. Their spread gives the noise of ours; that of the reference is estimated from the difference between the black and
the white squares of a chessboard laid over each block, both averaged over 3 x 3 blocks. Pixels of the reference that are
not finite are left out, and so are blocks that are brighter than --cut in it, which see lamps, and those beside them, over
which its filter spreads them. Printed is a row of the table in docs/validation.md: the ratio of the means by channel with
the standard error of ours, the ratio of the median block, the mean difference of blocks and how much of it the noise
explains, and the share of blocks within three standard deviations. Mitsuba only reads the EXR file.
"""

import argparse
from pathlib import Path

import mitsuba as mi
import numpy as np

import renders

BLOCK = 8
LUMINANCE = np.array([0.212671, 0.715160, 0.072169])


def blocks(picture):
    """Views of a picture as (rows, columns, 8, 8, 3)."""
    rows, columns = (side // BLOCK for side in picture.shape[:2])
    return picture[: rows * BLOCK, : columns * BLOCK].reshape(rows, BLOCK, columns, BLOCK, 3).swapaxes(1, 2)


def reference(file, scale):
    """The means of the blocks of a picture and the variance of their luminance."""
    pieces = blocks(scale * np.array(mi.Bitmap(file).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)))
    pieces = np.where(np.isfinite(pieces).all(axis=-1, keepdims=True), pieces, np.nan)
    white = (np.indices((BLOCK, BLOCK)).sum(axis=0) % 2 == 0)[..., None]
    halves = [np.nanmean(np.where(color, pieces, np.nan), axis=(2, 3)) @ LUMINANCE for color in (white, ~white)]
    return np.nanmean(pieces, axis=(2, 3)), (0.5 * (halves[0] - halves[1])) ** 2


def smooth(values, counts):
    """The mean over those of 3 x 3 neighbours that count."""
    rows, columns = values.shape
    padded = [np.pad(array, 1) for array in (np.where(counts, values, 0.0), counts.astype(float))]
    total, number = (sum(array[y : y + rows, x : x + columns] for y in range(3) for x in range(3)) for array in padded)
    return total / np.maximum(number, 1.0)


def near(marked):
    """What is marked or has a marked neighbour."""
    return smooth(marked.astype(float), np.ones_like(marked)) > 0.0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("reference")
    renders.arguments(parser)
    parser.add_argument("--integrator", help="the file's by default")
    parser.add_argument("--passes", type=int, default=64, help="per run")
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--cut", type=float, default=4.0, help="blocks brighter than this are left out")
    parser.add_argument("--variant", default="scalar_rgb")
    parser.add_argument("--scale", type=float, default=1.0, help="multiply the reference by this")
    parser.add_argument("--keep", help="write the blocks of ours and theirs to this .npz")
    options = parser.parse_args()
    mi.set_variant(options.variant)

    theirs, their_variance = reference(options.reference, options.scale)
    options.set.append("filter=box")
    size = f"{theirs.shape[1]}x{theirs.shape[0]}"
    with renders.edited(options) as options:
        runs = [renders.render(options, run, size, options.passes, options.integrator)[0] for run in range(options.runs)]
    runs = np.stack(runs)
    ours, our_variance = runs.mean(axis=0), (runs @ LUMINANCE).var(axis=0, ddof=1) / len(runs)
    if options.keep:
        np.savez(options.keep, ours=ours, theirs=theirs, our_variance=our_variance, their_variance=their_variance)

    dark = ~near(~np.isfinite(theirs).all(axis=-1) | (theirs.max(axis=-1) > options.cut))
    ratio = ours[dark].mean(axis=0) / theirs[dark].mean(axis=0)
    means = runs[:, dark].mean(axis=1)
    error = (means.std(axis=0, ddof=1) / np.sqrt(len(runs)) / means.mean(axis=0)).max()
    difference = (ours - theirs) @ LUMINANCE
    sigma = np.sqrt(smooth(our_variance, dark) + smooth(np.nan_to_num(their_variance), dark))
    mean = (theirs @ LUMINANCE)[dark].mean()
    median = np.median(((ours @ LUMINANCE) / (theirs @ LUMINANCE))[dark])
    off, noise = np.abs(difference)[dark].mean() / mean, np.sqrt(2 / np.pi) * sigma[dark].mean() / mean
    within = np.mean(np.abs(difference)[dark] <= 3 * sigma[dark])
    print(f"| {Path(options.scene).parts[-3]} | {options.integrator or 'its own'} | "
          f"{', '.join(f'{channel:.4f}' for channel in ratio)} ± {error:.4f} | {median:.4f} | "
          f"{100 * off:.1f} % ({100 * noise:.1f} %) | {100 * within:.1f} % of {dark.sum()} |")


if __name__ == "__main__":
    main()
