#!/usr/bin/env python3
"""The shape behind the corner, from a capture of a relay wall: filtered backprojection by y-tal.

    pip install y-tal matplotlib
    hidden_shape.py CAPTURE.hdf5 PICTURE.png [VOXEL]

The volume is 1.6 m wide and high and lies 0.6 to 1.4 m in front of a wall at z = 0. The picture shows the brightest voxel along z
as the wall sees it: +y up, +x to the left. VOXEL is the side of one in metres (0.02).
"""

import sys

import matplotlib
import numpy as np
import tal

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def main() -> None:
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    capture, picture = sys.argv[1:3]
    voxel = float(sys.argv[3]) if len(sys.argv) == 4 else 0.02
    data = tal.io.read_capture(capture)
    volume = tal.reconstruct.get_volume_min_max_resolution(
        minimal_pos=np.array([-0.8, -0.8, 0.6]), maximal_pos=np.array([0.8, 0.8, 1.4]), resolution=voxel
    )
    # A wave of 5 voxels tells two of them apart.
    found = tal.reconstruct.fbp.solve(
        data,
        wl_mean=5 * voxel,
        wl_sigma=5 * voxel,
        volume_xyz=volume,
        volume_format=tal.enums.VolumeFormat.X_Y_Z_3,
        camera_system=tal.enums.CameraSystem.DIRECT_LIGHT,
    )
    found = np.abs(found)
    print("brightest at", volume[np.unravel_index(found.argmax(), found.shape)])
    front = found.max(axis=2).T[::-1, ::-1]
    scale = max(1, 320 // len(front))
    plt.imsave(picture, np.kron(front, np.ones((scale, scale))), cmap="magma")


if __name__ == "__main__":
    main()
