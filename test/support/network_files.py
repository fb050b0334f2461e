"""Tiny networks of darknet and Caffe, which find coloured squares as those of networks.py do."""

import struct

import numpy as np
from network_graph import CLASSES, SIZE

ANCHOR = (16, 8)  # px, width and height of all boxes
DARKNET = f"""[net]
# of a test
batch=1
width={SIZE}
height={SIZE}
channels=3

[convolutional]
filters={5 + CLASSES}
size=8
stride=8
pad=0
activation=linear

[yolo]
mask=0
anchors={ANCHOR[0]},{ANCHOR[1]}
classes={CLASSES}
num=1
"""


def darknet_weights() -> bytes:
    """The weights of DARKNET: the logit of a class is -20 without its colour, and 20 with it."""
    filters = 5 + CLASSES
    biases = np.array([0, 0, 0, 0, 20] + [-20] * CLASSES, np.float32)
    weights = np.zeros((filters, 3, 8, 8), np.float32)
    for class_id in range(CLASSES):  # the channels are red, green and blue
        weights[5 + class_id, class_id] = 40.0 / 64.0
    # Three numbers of the version, then how many images it was trained with.
    return struct.pack("<iiiq", 0, 2, 0, 0) + biases.tobytes() + weights.tobytes()


# The mean of each cell is its confidences: blue is no object (class 0), green 1, and red 2. The box
# of each is its prior, as all offsets are 0. So it needs no weights.
CAFFE = f"""name: "tiny"
input: "data"
input_shape {{ dim: 1 dim: 3 dim: {SIZE} dim: {SIZE} }}
layer {{
  name: "mean" type: "Pooling" bottom: "data" top: "mean"
  pooling_param {{ pool: AVE kernel_size: 8 stride: 8 }}
}}
layer {{
  name: "by_cell" type: "Permute" bottom: "mean" top: "by_cell"
  permute_param {{ order: 0 order: 2 order: 3 order: 1 }}
}}
layer {{ name: "scores" type: "Flatten" bottom: "by_cell" top: "scores" }}
layer {{
  name: "one" type: "Slice" bottom: "mean" top: "first" top: "second" top: "third"
  slice_param {{ axis: 1 slice_point: 1 slice_point: 2 }}
}}
layer {{
  name: "four" type: "Concat" bottom: "mean" bottom: "first" top: "four"
  concat_param {{ axis: 1 }}
}}
layer {{
  name: "nothing" type: "Power" bottom: "four" top: "nothing"
  power_param {{ scale: 0 }}
}}
layer {{ name: "offsets" type: "Flatten" bottom: "nothing" top: "offsets" }}
layer {{
  name: "priors" type: "PriorBox" bottom: "mean" bottom: "data" top: "priors"
  prior_box_param {{ min_size: 16 variance: 0.1 variance: 0.1 variance: 0.2 variance: 0.2 }}
}}
layer {{
  name: "detection_out" type: "DetectionOutput"
  bottom: "offsets" bottom: "scores" bottom: "priors" top: "detection_out"
  detection_output_param {{
    num_classes: 3 share_location: true background_label_id: 0
    nms_param {{ nms_threshold: 0.45 top_k: 100 }}
    code_type: CENTER_SIZE keep_top_k: 100 confidence_threshold: 0.1
  }}
}}
"""
CAFFE_MODEL = b"\x0a\x04tiny"  # a network with a name, and no layers with weights
