"""FovVideoVDP of one eye's clip, at a gaze that may differ from frame to frame.

Argument: a JSON file with folder-relative names of the two clips (8-bit sRGB, frame by frame, row by row) and what they
are. Prints one JSON object.
"""

import json
import pathlib
import sys
from importlib.metadata import version

import numpy as np
import pyfvvdp
import torch
from pyfvvdp.fvvdp_display_model import fvvdp_display_geometry, fvvdp_display_photo_eotf


def main():
    path = pathlib.Path(sys.argv[1])
    job = json.loads(path.read_text())
    shape = (job["frames"], job["height"], job["width"], 3)
    reference, test = (
        np.fromfile(path.parent / job[name], dtype=np.uint8).reshape(shape) for name in ("reference", "test")
    )
    metric = pyfvvdp.fvvdp(
        display_photometry=fvvdp_display_photo_eotf(job["white_cd_m2"], contrast=job["contrast"], EOTF="sRGB"),
        display_geometry=fvvdp_display_geometry(
            (job["width"], job["height"]), distance_m=1, fov_horizontal=job["fov_horizontal_deg"]
        ),
        foveated=True,
        quiet=True,
        device=torch.device("cpu"),  # so that every machine finds the same
    )
    if job["frames"] == 1:
        gaze = np.array(job["gaze_px"][0])
    else:
        gaze = np.array(job["gaze_px"])
    jod, _ = metric.predict(
        test, reference, dim_order="FHWC", frames_per_second=job["refresh_hz"], fixation_point=gaze
    )
    print(json.dumps({"jod": float(jod), "version": version("pyfvvdp")}))


main()
