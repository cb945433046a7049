#!/usr/bin/env python3
"""Computes crates/lampyris/src/spectrum/curves.rs: three reflectances that look, in daylight, like the primaries of sRGB.

The idea is that of [Mallett & Yuksel 2019]; the curves are found here from the tables of `observer.rs` alone. They are the
smoothest (least sum of squared second differences) for which, at every wavelength,

    0 <= red, green, blue      and      red + green + blue = 1,

and which the CIE 1931 observer sees under D65 as linear sRGB (1, 0, 0), (0, 1, 0) and (0, 0, 1), where a constant 1 is
(1, 1, 1). Between the entries of every table values are linear, so that each cell of 5 nm has a cubic to integrate, for
which Simpson's rule is exact.

    scripts/primary_curves.py            # prints the table; needs numpy and scipy
"""
import pathlib
import re

import numpy as np
from scipy.optimize import lsq_linear

SPECTRUM = pathlib.Path(__file__).parent.parent / "crates/lampyris/src/spectrum"
# XYZ to linear RGB, as in eye.rs.
TO_RGB = np.array([[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]])
NODES = 81


def observer():
    """x, y, z matching functions (81, 3) every 5 nm and D65 (41) every 10 nm, from 380 nm."""
    text = (SPECTRUM / "observer.rs").read_text()
    numbers = lambda name: [float(n) for n in re.findall(r"-?\d+\.\d+", re.search(name + r".*?= \[(.*?)\];", text, re.S)[1])]
    return np.array(numbers("MATCHING")).reshape(NODES, 3), np.array(numbers("D65"))


def weights():
    """(3, 81): what each entry of a reflectance adds to each channel of linear RGB."""
    matching, daylight = observer()
    channels, power = matching @ TO_RGB.T, np.interp(np.arange(NODES), np.arange(0, NODES, 2), daylight)
    light = np.zeros((3, NODES))
    for cell in range(NODES - 1):
        for t, simpson in ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6)):
            value = ((1 - t) * channels[cell] + t * channels[cell + 1]) * ((1 - t) * power[cell] + t * power[cell + 1])
            light[:, cell] += simpson * value * (1 - t)
            light[:, cell + 1] += simpson * value * t
    return light / light.sum(axis=1, keepdims=True)


def curves():
    """(3, 81): red, green and blue."""
    sees, one, nothing = weights(), np.eye(NODES), np.zeros((3, NODES))
    rough = np.kron(np.eye(3), np.diff(np.eye(NODES), 2, axis=0))
    # Each curve to its primary, and all together to 1. The channels of blue follow from the others.
    equal = np.vstack([np.hstack([sees, nothing, nothing]), np.hstack([nothing, sees, nothing]), np.hstack([one] * 3)])
    target = np.concatenate([[1.0, 0, 0, 0, 1, 0], np.ones(NODES)])
    # Least squares with heavy constraints tells which entries lie on a bound; then the rest is a linear system.
    heavy = 1e4
    near = lsq_linear(
        np.vstack([rough, heavy * equal]), np.concatenate([np.zeros(len(rough)), heavy * target]), (0, 1), "bvls"
    ).x
    bound = (near < 1e-9) | (near > 1 - 1e-9)
    free, fixed = np.flatnonzero(~bound), np.where(near > 0.5, 1.0, 0.0) * bound
    hessian, left = (rough.T @ rough)[np.ix_(free, free)], equal[:, free]
    system = np.block([[hessian, left.T], [left, np.zeros((len(left), len(left)))]])
    right = np.concatenate([-(rough.T @ rough)[free] @ fixed, target - equal @ fixed])
    found = fixed.copy()
    found[free] = np.linalg.lstsq(system, right, rcond=None)[0][: len(free)]
    assert found.min() > -1e-9 and found.max() < 1 + 1e-9 and np.abs(equal @ found - target).max() < 1e-9
    return found.clip(0, 1).reshape(3, NODES)


def main():
    red, green, _ = curves().round(7)
    found = np.array([red, green, (1 - red - green).round(7)])
    assert found.min() >= 0
    worst = np.abs(weights() @ found.T - np.eye(3)).max()
    print("//! Reflectances of the sRGB primaries, as `scripts/primary_curves.py` computes and explains them.\n")
    print("/// Red, green and blue every 5 nm from 380 to 780 nm: they add up to 1, and under D65 the observer sees just the")
    print(f"/// primaries, to {worst:.0e}.")
    print("#[rustfmt::skip]")
    print(f"pub(super) const PRIMARIES: [[f64; 3]; {NODES}] = [")
    for row in found.T:
        print("    [" + ", ".join(repr(float(value)) for value in row.round(7)) + "],")
    print("];")


if __name__ == "__main__":
    main()
