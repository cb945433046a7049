#!/usr/bin/env python3
"""Times Lampyris against the path tracing of Mitsuba 3 to equal error, on the same scene at the same depth.

    pip install mitsuba
    python scripts/time_against_mitsuba.py SCENE.xml [--size 256x256] [--samples 64] [--runs 8] [--integrator path] [--define NAME=VALUE]

Each program renders the scene `--runs` times with different seeds, in turns. The error is relMSE, the mean over pixels
and channels of variance / (mean^2 + 0.01): the variance is that between a program's own runs, the mean that of all.
The table gives for each program the seconds of one run (of processor time over all threads, and of the clock, without
loading), its error, and the seconds that an error of `--target` takes if errors fall as 1 / time. The last figure is
the ratio of those, ours over theirs; `trimmed` leaves out the 0.1 % of pixels that are worst in either.
Mitsuba's `llvm_ad_rgb` needs a working LLVM in DRJIT_LIBLLVM_PATH; rustc's own (lib/libLLVM.so.* of a toolchain) works.
"""

import argparse
import resource
import time

import mitsuba as mi
import numpy as np

import renders


def mitsuba_run(scene, options, seed):
    """A picture, the processor's seconds and the clock's."""
    processor, clock = time.process_time(), time.perf_counter()
    picture = np.array(mi.render(scene, spp=options.samples, seed=seed))[..., :3]
    return picture, time.process_time() - processor, time.perf_counter() - clock


def lampyris_run(options, seed):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    picture, statistics = renders.render(options, seed, options.size, options.passes or options.samples, options.integrator)
    all_clock = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    clock = sum(statistics["seconds"][phase] for phase in ("pilot", "photons", "map", "camera"))
    return picture, processor * clock / all_clock, clock


def error(runs, mean, keep=None):
    variance = runs.var(axis=0, ddof=1) / (mean**2 + 0.01)
    return variance.mean(axis=-1) if keep is None else variance.mean(axis=-1)[keep].mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    renders.arguments(parser, threads=2)
    parser.add_argument("--size", default="256x256")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--passes", type=int, help="of Lampyris, if not --samples")
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--integrator", default="path", help="of Lampyris; Mitsuba traces paths")
    parser.add_argument("--target", type=float, default=0.01)
    parser.add_argument("--mitsuba-scene", help="what Mitsuba renders instead, where its own file needs an edit")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    options = parser.parse_args()

    mi.set_variant(options.variant)
    mi.Thread.set_thread_count(options.threads) if hasattr(mi.Thread, "set_thread_count") else None
    theirs, ours = [], []
    with renders.edited(options) as options:
        scene = mi.load_file(options.mitsuba_scene or options.scene, **dict(pair.split("=") for pair in options.define))
        mitsuba_run(scene, options, 1000)  # compiles its kernels
        for seed in range(options.runs):
            theirs.append(mitsuba_run(scene, options, seed))
            ours.append(lampyris_run(options, seed))
    pictures = {"Mitsuba": np.stack([run[0] for run in theirs]), "Lampyris": np.stack([run[0] for run in ours])}
    mean = np.concatenate(list(pictures.values())).mean(axis=0)
    worst = sum(error(runs, mean) for runs in pictures.values())
    keep = worst <= np.quantile(worst, 0.999)
    needs = {}
    print(f"{'':10} {'CPU s':>8} {'s':>8} {'relMSE':>10} {'trimmed':>10} {'CPU s to ' + str(options.target):>14} {'trimmed':>10}")
    for name, runs in [("Mitsuba", theirs), ("Lampyris", ours)]:
        processor, clock = (float(np.median([run[index] for run in runs])) for index in (1, 2))
        whole, trimmed = error(pictures[name], mean).mean(), error(pictures[name], mean, keep)
        needs[name] = [processor * value / options.target for value in (whole, trimmed)]
        print(f"{name:10} {processor:8.2f} {clock:8.2f} {whole:10.5f} {trimmed:10.5f} {needs[name][0]:14.2f} {needs[name][1]:10.2f}")
    ratio = pictures["Lampyris"].mean() / pictures["Mitsuba"].mean()
    print(f"ours / theirs: {needs['Lampyris'][0] / needs['Mitsuba'][0]:.2f}, trimmed "
          f"{needs['Lampyris'][1] / needs['Mitsuba'][1]:.2f}; ratio of the means {ratio:.4f}")


if __name__ == "__main__":
    main()
