"""FovVideoVDP of one eye's clip, at a gaze that may differ from frame to frame.

Argument: a JSON file with folder-relative names of the two clips (8-bit sRGB, frame by frame, row by row) and what they
are. Prints one JSON object: the JOD, and the differences of each frame that it is the mean of.
"""

import json
import pathlib
import sys
from importlib.metadata import version

import numpy as np
import pyfvvdp
import torch
from pyfvvdp.fvvdp_display_model import fvvdp_display_geometry, fvvdp_display_photo_eotf


def differences(metric, per_channel):
    """As `fvvdp.do_pooling_and_jods`, but not pooled over frames: 10 - mean(by_frame) ** exponent is the JOD."""
    if metric.beta_t != 1 or metric.jod_a >= 0:
        sys.exit("pyfvvdp has parameters that are not those of 1.2.2")
    per_channel = torch.as_tensor(per_channel)  # bands, temporal channels, frames
    weights = torch.tensor([1.0, metric.w_transient]).reshape(1, 2, 1)
    bands = metric.lp_norm(per_channel * weights, metric.beta_sch, 0, False)
    channels = metric.lp_norm(bands, metric.beta_tch, 1, False).flatten()
    exponent = 10.0**metric.log_jod_exp
    return {"by_frame": (abs(metric.jod_a) ** (1 / exponent) * channels).tolist(), "exponent": exponent}


def main():
    torch.set_num_threads(1)  # several of these may run at once, and sums do not depend on the machine
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
    jod, stats = metric.predict(
        test, reference, dim_order="FHWC", frames_per_second=job["refresh_hz"], fixation_point=gaze
    )
    by_frame = differences(metric, stats["Q_per_ch"])
    print(json.dumps({"jod": float(jod), "version": version("pyfvvdp"), **by_frame}))


main()
