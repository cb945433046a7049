#!/usr/bin/env python3
"""Renders a Mitsuba scene with Mitsuba and with Lampyris, and tests whether the pictures agree.

    pip install mitsuba scipy
    python scripts/agree_with_mitsuba.py SCENE.xml [--size 128x128] [--samples 64] [--runs 16] [--integrator path]

Where Mitsuba 3 cannot read the file, `--replace OLD NEW` and `--without NAME` (of parameters) edit a copy for both programs,
and `--mitsuba-scene` names another file for Mitsuba alone. `--border` lets Mitsuba draw samples beyond the film's border,
as Lampyris does.

Each program renders the scene `--runs` times with different seeds; the spread of these runs gives the error of every
pixel's mean. Two figures are printed: the ratio of the means over the picture with its standard error, and the share of
pixels that pass Welch's t-test with Sidak's correction at 1 %. The exit status is 0 if the means agree within 0.5 % and
at least 99.75 % of the pixels pass.
"""

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import mitsuba as mi
import numpy as np
from scipy import stats

import renders

LUMINANCE = np.array([0.212671, 0.715160, 0.072169])


def mitsuba_runs(options, size):
    mi.set_variant(options.variant)
    scene = mi.load_file(options.mitsuba_scene or options.scene, **dict(pair.split("=") for pair in options.define))
    film = scene.sensors()[0].film()
    if tuple(film.size()) != size:
        sys.exit(f"Mitsuba's film is {film.size()}: pass --define resx={size[0]} --define resy={size[1]} or edit the scene")
    return [np.array(mi.render(scene, spp=options.samples, seed=run))[..., :3] for run in range(options.runs)]


def lampyris_runs(options, size):
    passes, size = options.passes or options.samples, f"{size[0]}x{size[1]}"
    return [renders.render(options, run, size, passes, options.integrator)[0] for run in range(options.runs)]


def arguments(parser, size="128x128"):
    """The options of a comparison."""
    renders.arguments(parser)
    parser.add_argument("--size", default=size)
    parser.add_argument("--samples", type=int, default=64, help="per pixel and run")
    parser.add_argument("--passes", type=int, help="of Lampyris per run, if not --samples")
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--integrator", default="path")
    parser.add_argument("--mitsuba-scene", help="what Mitsuba renders instead, where its own file needs an edit")
    parser.add_argument("--variant", default="scalar_rgb")
    parser.add_argument("--keep", metavar="FOLDER", help="keep the pictures there, and take Mitsuba's from there")
    parser.add_argument("--clip", type=float, help="cut pixels at this value in every run, against fireflies")


@dataclass
class Agreement:
    """How well two sets of pictures agree."""

    ratio: float
    error: float
    channels: np.ndarray
    passing: float
    pixels: int

    @property
    def good(self):
        return abs(self.ratio - 1.0) <= 0.005 and self.passing >= 0.9975

    def row(self):
        """Two cells of a table."""
        return f"{self.ratio:.4f} ± {self.error:.4f} | {100 * self.passing:.3f} %"


def compare(options):
    """Renders `options.scene` with both programs."""
    with renders.edited(options) as options:
        return compare_files(options)


def compare_files(options):
    size = tuple(int(side) for side in options.size.split("x"))
    kept = Path(options.keep or "") / "mitsuba.npy"
    theirs = np.load(kept) if options.keep and kept.exists() else np.stack(mitsuba_runs(options, size))
    ours = np.stack(lampyris_runs(options, size))
    if options.keep:
        kept.parent.mkdir(parents=True, exist_ok=True)
        np.save(kept, theirs)
        np.save(kept.with_name("lampyris.npy"), ours)
    if options.clip:
        theirs, ours = np.minimum(theirs, options.clip), np.minimum(ours, options.clip)
    means = [pictures.mean(axis=(1, 2, 3)) for pictures in (ours, theirs)]
    ratio = means[0].mean() / means[1].mean()
    error = ratio * np.sqrt(sum((mean.std(ddof=1) / mean.mean()) ** 2 / len(mean) for mean in means))
    channels = ours.mean(axis=(0, 1, 2)) / theirs.mean(axis=(0, 1, 2))

    _, p = stats.ttest_ind(ours @ LUMINANCE, theirs @ LUMINANCE, axis=0, equal_var=False)
    p = np.where(np.isnan(p), 1.0, p)  # no spread at all: both programs give the same value in every run
    same = np.isclose((ours @ LUMINANCE).mean(axis=0), (theirs @ LUMINANCE).mean(axis=0), rtol=1e-4, atol=1e-6)
    threshold = 1.0 - (1.0 - 0.01) ** (1.0 / p.size)
    passing = np.mean((p >= threshold) | same)
    return Agreement(ratio, error, channels, passing, p.size)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    arguments(parser)
    options = parser.parse_args()
    result = compare(options)
    channels = ", ".join(f"{channel:.5f}" for channel in result.channels)
    print(f"{Path(options.scene).name} {options.integrator}: mean ratio {result.ratio:.5f} ± {result.error:.5f} "
          f"(channels {channels}), {100 * result.passing:.3f} % of {result.pixels} pixels pass")
    sys.exit(0 if result.good else 1)


if __name__ == "__main__":
    main()
