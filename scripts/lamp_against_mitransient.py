#!/usr/bin/env python3
"""A small lamp through glass, in Lampyris and in mitransient for the same seconds of processor, against a long render of ours.

    pip install mitransient 'mitsuba==3.8.*'     (DRJIT_LIBLLVM_PATH must name an LLVM library)
    python scripts/lamp_against_mitransient.py scenes/laser/lamp.xml [--seconds 20] [--runs 4] [--define lamp=0.1]...

Told are, of bins whose light is a caustic by at least a half and of all others, how many have light in a run, the light found, as a
share of that of the long render, with its standard deviation between runs, and relMSE, the mean over bins of
(x - r)^2 / (r^2 + 0.01 m^2), with m the mean of all bins that have light. Whether both programs mean the same is for agree_with_mitransient.py to tell, with a lamp so
large that mitransient finds it.
"""

import argparse
import subprocess
import tempfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np

import agree_with_mitransient as both

AT_ONCE = 256
"""Samples a pixel that mitransient takes at once: all of them have to be in memory."""


def reference(options):
    """All light, and the share of it that is a caustic, by bin."""
    with tempfile.TemporaryDirectory() as folder:
        film = Path(folder) / "film.npz"
        command = [options.lampyris, "render", options.scene, "--define", f"res={options.size}", "--quiet", "--seed", "1000"]
        command += [part for define in options.define for part in ("--define", define)]
        command += ["--set", 'time.layers=["caustic"]', "--passes", str(options.reference), "-o", film]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        arrays = np.load(film)
        light = arrays["transient"].astype(np.float64)
        return light, arrays["caustic"] / np.maximum(light, 1e-30)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--size", type=int, default=96)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--runs", type=int, default=4)
    parser.add_argument("--reference", type=int, default=8000, help="passes of the long render")
    parser.add_argument("--define", action="append", default=[], help="NAME=VALUE, of a parameter of the scene")
    parser.add_argument("--lampyris", default="target/release/lampyris")
    options = parser.parse_args()

    def of(program, samples, runs):
        return program(SimpleNamespace(**vars(options) | {"samples": samples, "passes": None, "runs": runs, "integrator": "auto", "set": []}))

    light, caustic = reference(options)
    scale = 0.01 * light[light > 0].mean() ** 2
    parts = {"caustic": caustic >= 0.5, "other": caustic < 0.5}
    for name, part in parts.items():
        print(f"{name}: {part.sum()} bins with {100 * light[part].sum() / light.sum():.1f} % of the light")

    passes = round(64 * options.seconds / of(both.ours, 64, 1)[1])
    ours, spent = of(both.ours, passes, options.runs)
    found = {"Lampyris": (ours, spent, passes)}
    rounds = max(1, round(options.seconds / of(both.theirs, AT_ONCE, 2)[1]))
    theirs, spent = of(both.theirs, AT_ONCE, rounds * options.runs)
    theirs = theirs.reshape(options.runs, rounds, *theirs.shape[1:]).mean(1, dtype=np.float64)
    found["mitransient"] = (theirs, spent * rounds, AT_ONCE * rounds)
    for program, (films, spent, samples) in found.items():
        print(f"{program}: {spent:.1f} CPU s, {samples} samples a pixel")
        for name, part in parts.items():
            shares = np.array([film[part].sum(dtype=np.float64) / light[part].sum() for film in films])
            error = np.mean([((film - light)[part] ** 2 / (light[part] ** 2 + scale)).mean() for film in films])
            lit = np.mean([(film[part] > 0).mean() for film in films])
            print(f"    {name}: {100 * lit:.1f} % of the bins lit, ", end="")
            print(f"{100 * shares.mean():.1f} % +- {100 * shares.std(ddof=1):.1f} % of the light, relMSE {error:.4f}")


if __name__ == "__main__":
    main()
