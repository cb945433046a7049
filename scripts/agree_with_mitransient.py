#!/usr/bin/env python3
"""A scene with time in Lampyris and in mitransient: the total and every bin, by z-test, and the noise of both at equal time.

    pip install mitransient 'mitsuba==3.8.*'     (DRJIT_LIBLLVM_PATH must name an LLVM library)
    python scripts/agree_with_mitransient.py SCENE.xml [--size 64] [--samples 256] [--runs 16] [--integrator path] [--define NAME=VALUE]...
        [--set KEY=VALUE]... [--reference PASSES]

Both load the same file, with its parameter `res` for the size. Bins are compared in blocks of 8x8 pixels, where light fell in
at least half of the runs of both. The noise is relMSE, the mean over bins of the variance between a program's runs over
(mean^2 + 0.01 m^2), with m the mean of all bins that have light; seconds are those of the processor. What photon mapping blurs
is no noise: it is how far the means are apart.

The mean of few runs is too small where light is rare, and so is relMSE with it. With --reference, r is a render of so many passes of
`auto` with a seed of its own instead, and relMSE the mean of (x - r)^2 / (r^2 + 0.01 m^2): all that is wrong, blur, too,
and what is wrong with the reference.
"""

import argparse
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np
from scipy import stats

mi.set_variant("llvm_ad_rgb")
import mitransient  # noqa: E402, F401

BLOCK = 8


def theirs(options):
    scene = mi.load_file(options.scene, res=options.size, **dict(define.split("=") for define in options.define))
    mi.render(scene, spp=1)  # compiles
    found, start = [], time.process_time()
    for seed in range(options.runs):
        found.append(np.array(mi.render(scene, spp=options.samples, seed=seed)[1], np.float32))
    return np.array(found), (time.process_time() - start) / options.runs


def film(options, integrator, passes, seed, settings):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.npy"
        command = [options.lampyris, "render", options.scene, "--define", f"res={options.size}", "--quiet"]
        command += [part for define in options.define for part in ("--define", define)]
        command += ["--integrator", integrator, "--passes", str(passes), "--seed", str(seed), "-o", path]
        command += [part for each in settings for part in ("--set", each)]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        return np.load(path)


def ours(options):
    def seconds():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    passes, before = options.passes or options.samples, seconds()
    found = [film(options, options.integrator, passes, seed, options.set) for seed in range(options.runs)]
    return np.array(found), (seconds() - before) / options.runs


def blocks(runs):
    count, height, width, bins, channels = runs.shape
    shape = (count, height // BLOCK, BLOCK, width // BLOCK, BLOCK, bins, channels)
    return runs[:, : height // BLOCK * BLOCK, : width // BLOCK * BLOCK].reshape(shape).mean((2, 4), dtype=np.float64)


def t(a, b):
    """Welch's t and its degrees of freedom, along the first axis."""
    errors = [runs.var(0, ddof=1) / len(runs) for runs in (a, b)]
    with np.errstate(invalid="ignore", divide="ignore"):
        freedom = sum(errors) ** 2 / sum(error**2 / (len(runs) - 1) for error, runs in zip(errors, (a, b)))
        return (a.mean(0) - b.mean(0)) / np.sqrt(sum(errors)), freedom


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--passes", type=int, help="of Lampyris, if not --samples")
    parser.add_argument("--runs", type=int, default=16)
    parser.add_argument("--integrator", default="path")
    parser.add_argument("--define", action="append", default=[], help="NAME=VALUE, of a parameter of the scene")
    parser.add_argument("--set", action="append", default=[], help="KEY=VALUE, of a setting of Lampyris")
    parser.add_argument("--reference", type=int, metavar="PASSES", help="of a reference to judge errors by")
    parser.add_argument("--lampyris", default="target/release/lampyris")
    options = parser.parse_args()
    names = ["Lampyris", "mitransient"]
    runs, seconds = zip(ours(options), theirs(options))
    totals = [each.mean((1, 2, 3, 4), dtype=np.float64) for each in runs]
    z, freedom = t(*totals)
    print(f"total: ratio {totals[0].mean() / totals[1].mean():.5f}, t = {z:.2f} with {freedom:.0f} degrees of freedom")
    a, b = (blocks(each) for each in runs)
    lit = ((a > 0).sum(0) >= options.runs // 2) & ((b > 0).sum(0) >= options.runs // 2)
    z, freedom = (values[lit] for values in t(a, b))
    # As a normal variable of the same probability, whose spread is known.
    normal = stats.norm.isf(stats.t.sf(np.abs(z), freedom)) * np.sign(z)
    most = stats.norm.isf(0.5 * (1 - 0.99 ** (1 / lit.sum())))
    print(f"{lit.sum()} bins of blocks: standard deviation of z {normal.std():.3f}, mean {normal.mean():.3f}", end="; ")
    print(f"{(np.abs(normal) > most).sum()} beyond {most:.2f} (Sidak, 1 %), most {np.abs(normal).max():.2f}")
    early = [(each > 0).any((0, 1, 2, 4)).argmax() for each in runs]
    print(f"first bin with light: {early[0]} and {early[1]}")
    mean = sum(each.mean(0) for each in runs) / 2
    if options.reference:
        mean = film(options, "auto", options.reference, 1000, []).astype(np.float64)
    scale = 0.01 * mean[mean > 0].mean() ** 2
    for name, each, spent in zip(names, runs, seconds):
        wrong = sum((run - mean) ** 2 for run in each) / len(each) if options.reference else each.var(0, ddof=1)
        noise = (wrong / (mean**2 + scale))[mean > 0].mean()
        print(f"{name}: {spent:.2f} CPU s, relMSE {noise:.4f}, times each other {spent * noise:.4f}")
    apart = (runs[0].mean(0) - runs[1].mean(0)) ** 2 - sum(each.var(0, ddof=1) / len(each) for each in runs)
    print(f"the means apart, without what noise explains: relMSE {(apart / (mean**2 + scale))[mean > 0].mean():.4f}")


if __name__ == "__main__":
    main()
